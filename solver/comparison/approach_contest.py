"""A contest of methods over the targets of an approach problem, judged by a plan's verifier."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from solver.approach.cut_in.cut_in import build_cut_in, line_deviation, retreat_rows
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask, approach_task
from solver.comparison.cold_start import solve_cold
from solver.comparison.contest import Account, Contest, Entrant, Published
from solver.exceptions import UnknownEntrant
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics
from solver.methods.any_arm import Solve
from solver.methods.registry import METHODS
from solver.problem.effort import posture_effort
from solver.problem.problem import Problem
from solver.problem.retreats import even_retreats
from solver.problem.solution import Reason, SolverReport
from solver.robots.model import Array
from solver.solving.one_target import solve_between_rows_too
from solver.solving.proposal import propose
from solver.verification.verify import refusal, verify

INDEX_NAME: Final = "effort [rad]"
COLD_STARTS: Final = 8
"""Random starts of a cold solve, as the benchmark of cold starts has them."""

TOLD_RESIDUALS: Final[tuple[str, ...]] = (
    "path_position_m",
    "path_axes_rad",
    "limit_excess_rad",
    "path_deviation_m",
)
"""Of the verifier's residuals, those that tell people something; the others check claims."""

BETWEEN_ROWS: Final = "deviation_between_rows_m"
"""How far joint-linear motion through the answered rows leaves the straight cut-in."""


@dataclass(frozen=True)
class Variant:
    """A method with its options, under the name that it has in a contest.

    Attributes:
        name: what rows call it; for a method as it is, the method's own name.
        summary: a line for people.
        problem: the targets with this variant's options; order "independent".
        solve: the method, on one target's task.
    """

    name: str
    summary: str
    problem: Problem
    solve: Solve


@dataclass(frozen=True)
class Answer:
    """What a variant answers for one target: the work that is timed.

    Attributes:
        outcome: the approach proposed, or why there is none.
        task: the task as it was solved last.
        rows: postures of the cut-in, shape (path_points, joints) [rad or m]; None without one.
    """

    outcome: Candidate | Reason
    task: ApproachTask
    rows: Array | None


def comparable(problem: Problem, **options: Any) -> Problem:
    """A problem as contests have it: each target on its own, untimed, with options by keyword.

    Without `position_margin_m`, which the texts compared with do not have.
    """
    kept: dict[str, Any] = {
        "order": "independent", "include": ("path",), "certify": False, "position_margin_m": 0.0,
    }  # fmt: skip
    return replace(problem, options=replace(problem.options, **(kept | options)))


def method_variants(problem: Problem) -> tuple[Variant, ...]:
    """Every method of the registry on the same problem."""
    return tuple(
        Variant(row.name, row.summary, comparable(problem, method=row.name), row.solve)
        for row in METHODS.values()
    )


def chosen(variants: Sequence[Variant], names: Sequence[str] | None) -> tuple[Variant, ...]:
    """The variants of these names, in the scenario's order; all of them for None.

    Raises:
        UnknownEntrant: no variant has one of the names.
    """
    if names is None:
        return tuple(variants)
    known = tuple(variant.name for variant in variants)
    for name in names:
        if name not in known:
            raise UnknownEntrant(name, known=known)
    return tuple(variant for variant in variants if variant.name in names)


def approach_contest(
    problem: Problem,
    variants: Sequence[Variant],
    *,
    scenario: str,
    title: str,
    origin: str,
    notes: Sequence[str] = (),
    published: Mapping[tuple[str, str], Published] | None = None,
    published_on: str = "",
    reference: str = "ncos",
    seeds: Sequence[int] = (),
    findings: Callable[[Mapping[tuple[str, str], Account]], tuple[str, ...]] | None = None,
) -> Contest:
    """The contest of variants whose problems have the same targets.

    Timed is a target's task, from its numbers to the rows of its cut-in; the task itself is made
    before. Everything counts from the start posture.

    Args:
        problem: what pictures are made from.
        variants: who competes.
        scenario: see `Contest`, as for the other arguments.
        title: see `Contest`.
        origin: see `Contest`.
        notes: see `Contest`.
        published: see `Contest`.
        published_on: see `Contest`.
        reference: see `Contest`.
        seeds: see `Contest`.
        findings: see `Contest`.
    """
    by_name = {variant.name: variant for variant in variants}
    return Contest(
        scenario=scenario,
        title=title,
        origin=origin,
        index_name=INDEX_NAME,
        target_ids=tuple(target.id for target in problem.targets),
        entrants=tuple(_entrant(variant) for variant in variants),
        account=lambda name, k, answer: _account(by_name[name].problem, k, answer),
        notes=tuple(notes),
        published=published or {},
        published_on=published_on,
        reference=reference,
        problem=comparable(problem),
        seeds=tuple(seeds),
        findings=findings,
    )


def _entrant(variant: Variant) -> Entrant:
    problem = variant.problem
    tasks = [approach_task(problem, target, problem.start) for target in problem.targets]

    def solve(k: int) -> Answer:
        return _answer(tasks[k], variant.solve)

    def cold(k: int) -> Answer:
        return _answer(
            tasks[k], lambda task: solve_cold(task, COLD_STARTS, problem.options.seed + k)
        )

    starts_cold = METHODS[problem.options.method].starts_cold
    starts_cold &= family_of(problem.robot, problem.mounted_tool).has_closed_form
    return Entrant(variant.name, variant.summary, solve, cold if starts_cold else None)


def _answer(task: ApproachTask, solve: Solve) -> Answer:
    outcome, solved = solve_between_rows_too(task, solve)
    if isinstance(outcome, Reason):
        return Answer(outcome, solved, None)
    retreats = even_retreats(task.options)
    rows = retreat_rows(task.robot, task.tool, outcome.thinning_joints, outcome.branch, retreats)
    return Answer(outcome, solved, rows)


def _account(problem: Problem, k: int, answer: Answer) -> Account:
    outcome, rows = answer.outcome, answer.rows
    if isinstance(outcome, Reason):
        return Account(False, outcome.code, outcome.detail)
    if rows is None or not np.isfinite(rows).all():
        detail = "the answer has a posture that is none: a value is not finite"
        return Account(False, "solver_failed", detail, iterations=outcome.iterations)
    target, start = problem.targets[k], problem.start
    report = SolverReport(problem.options.method, 0.0, outcome.iterations, outcome.status)
    cut_in = build_cut_in(answer.task, outcome)
    # What is judged are the rows that were answered, not those computed again.
    proposed = replace(
        propose(problem, target, outcome, cut_in, start, report), path_joints=np.asarray(rows)
    )
    verification = verify(problem, proposed, start)
    found = {residual.name: residual.value for residual in verification.residuals}
    residuals = {name: found[name] for name in TOLD_RESIDUALS if name in found}
    if not verification.accepted:
        reason = refusal(verification)
        return Account(
            False, reason.code, reason.detail, residuals=residuals, iterations=outcome.iterations
        )
    thinning, options = rows[-1], problem.options
    return Account(
        solved=True,
        status="planned",
        detail=outcome.status,
        index=posture_effort(thinning, start, problem.joint_weights, options.norm),
        residuals=residuals | {BETWEEN_ROWS: _between_rows(problem, rows)},
        margin=proposed.margin_rad,
        joints=tuple(float(value) for value in thinning),
        iterations=outcome.iterations,
    )


def _between_rows(problem: Problem, rows: Array) -> float:
    pose = forward_kinematics(problem.robot, problem.mounted_tool, rows[-1])
    return line_deviation(problem.robot, problem.mounted_tool, rows, pose[:3, 3], pose[:3, 2])
