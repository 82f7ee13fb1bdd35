"""Many targets planned together, without a loop in Python and without timed motion.

What cannot be vouched for here is left to `solver.solving.one_target`: a batch only ever saves
time.
"""

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.approach.cut_in.cut_in import many_retreat_rows
from solver.approach.optimum.batch import (
    Optima,
    chosen_paths,
    closed_form_optima,
    finer_paths,
    raised_optima,
)
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.packing import packed_targets
from solver.approach.task.task import approach_task
from solver.approach.uncertainty.levels import margin_levels
from solver.approach.uncertainty.robustness import displacement_margins
from solver.kinematics.families.registry import family_of
from solver.methods.registry import METHODS
from solver.methods.semi_analytic import OPTIMUM
from solver.problem.problem import Problem
from solver.problem.retreats import even_retreats
from solver.problem.solution import Approach, SolverReport
from solver.problem.targets import Target
from solver.robots.model import Array
from solver.sequencing.sequence import Stop
from solver.solving.one_target import solve_between_rows_too
from solver.tolerances import BATCH_PART
from solver.verification.many import ProposedPaths, judge_many


def plans_together(problem: Problem) -> bool:
    """Whether targets of a problem can be planned together."""
    options = problem.options
    return (
        METHODS[options.method].is_arc_optimum
        and not options.timed
        and not options.certify
        and "arcs" not in (options.include or ())
        and family_of(problem.robot, problem.mounted_tool).has_closed_form
    )


def plan_stops(
    problem: Problem, stops: Sequence[Stop], reference: Sequence[float]
) -> dict[str, Approach]:
    """Planned and verified approaches of a chain by target id, up to the first that is not.

    Args:
        problem: one that `plans_together` accepts.
        stops: neighbours in a batch planned as one, whose limits hold between rows.
        reference: the standby posture before the first, shape (6,) [rad].
    """
    if not stops:
        return {}
    targets = [stop.task.target for stop in stops]
    positions, directions = _vectors(targets)
    numbers = packed_targets(problem, positions, directions, np.asarray(problem.start))
    angles = np.array([stop.angle_rad for stop in stops])
    paths = chosen_paths(problem, numbers, [stop.arc for stop in stops], angles).joints
    branches = np.array([stop.arc.branch for stop in stops])
    proposed = ProposedPaths(
        target_ids=[target.id for target in targets],
        positions=positions,
        directions=directions,
        angles_rad=np.array([stop.candidate.approach_angle_rad for stop in stops]),
        tool_sides=np.array([stop.arc.tool_side for stop in stops]),
        branches=branches,
        paths=paths,
        references=np.concatenate(([np.asarray(reference)], paths[:-1, 0])),
        displacement_margins_m=_margins(problem, branches, paths),
    )
    reports = [
        SolverReport(problem.options.method, 0.0, stop.candidate.iterations, stop.candidate.status)
        for stop in stops
    ]
    planned = judge_many(problem, proposed, reports)
    # Behind one that fails, efforts would count from a posture where nobody stands.
    held = next((k for k, target in enumerate(targets) if target.id not in planned), len(targets))
    return {target.id: planned[target.id] for target in targets[:held]}


def plan_many(problem: Problem, targets: Sequence[Target]) -> dict[str, Approach]:
    """Planned and verified approaches by target id; targets that need a closer look are left out.

    Args:
        problem: one that `plans_together` accepts, of independent targets.
        targets: some of its targets.
    """
    planned: dict[str, Approach] = {}
    for first in range(0, len(targets), BATCH_PART):
        part = targets[first : first + BATCH_PART]
        started = time.perf_counter()
        proposed, refined = _proposed(problem, part)
        elapsed_s = (time.perf_counter() - started) / len(part)
        reports = [
            SolverReport(problem.options.method, elapsed_s, cells, OPTIMUM) for cells in refined
        ]
        planned |= judge_many(problem, proposed, reports)
    return planned


def _proposed(problem: Problem, targets: Sequence[Target]) -> tuple[ProposedPaths, list[int]]:
    """Approaches of the targets that have one, and how many cells each took."""
    positions, directions = _vectors(targets)
    optima = closed_form_optima(problem, positions, directions, np.asarray(problem.start))
    levels = [margin_levels(problem.options, target) for target in targets]
    margins = None
    if max(map(max, levels)) > 0.0:
        optima, margins = raised_optima(problem, positions, directions, levels, optima)
    leaves = _leave_between_rows(problem, positions, directions, optima)
    optima = _exchanged(problem, targets, optima, leaves)
    kept = np.flatnonzero(optima.branches != NO_BRANCH)
    branches, paths = optima.branches[kept], optima.paths[kept]
    if margins is None:
        margins = _margins(problem, branches, paths)
    else:
        margins, anew = margins[kept], leaves[kept]
        margins[anew] = _margins(problem, branches[anew], paths[anew])
    proposed = ProposedPaths(
        target_ids=[targets[k].id for k in kept.tolist()],
        positions=positions[kept],
        directions=directions[kept],
        angles_rad=np.array([signed_angle(angle) for angle in optima.angles_rad[kept].tolist()]),
        tool_sides=optima.tool_sides[kept],
        branches=branches,
        paths=paths,
        references=np.broadcast_to(np.asarray(problem.start), (len(kept), 6)),
        displacement_margins_m=margins,
    )
    return proposed, optima.refined[kept].tolist()


def _margins(problem: Problem, branches: NDArray[np.int64], paths: Array) -> Array:
    """How far the targets of n cut-ins may move, shape (n,) [m]."""
    robot, tool, options = problem.robot, problem.mounted_tool, problem.options
    thinning = np.ascontiguousarray(paths[:, -1])
    return displacement_margins(robot, tool, options, branches, thinning)


def _leave_between_rows(
    problem: Problem, positions: Array, directions: Array, optima: Optima
) -> NDArray[np.bool_]:
    """Whether a cut-in may be infeasible between what is looked at, on a second look too, (n,)."""
    leaves: NDArray[np.bool_] = optima.suspicious & (optima.branches != NO_BRANCH)
    again = np.flatnonzero(leaves)
    if len(again):
        leaves[again] = finer_paths(problem, positions, directions, optima, again).suspicious
    return leaves


def _exchanged(
    problem: Problem, targets: Sequence[Target], optima: Optima, leaves: NDArray[np.bool_]
) -> Optima:
    """The optima with those that leave between rows solved again; without a branch where none is.

    One by one, as each has rows of its own.
    """
    which = np.flatnonzero(leaves)
    if not len(which):
        return optima
    angles, sides = optima.angles_rad.copy(), optima.tool_sides.copy()
    branches, paths = optima.branches.copy(), optima.paths.copy()
    efforts, refined = optima.efforts.copy(), optima.refined.copy()
    branches[which], efforts[which] = NO_BRANCH, np.nan
    for k in which.tolist():
        task = approach_task(problem, targets[k], problem.start)
        angle, side = signed_angle(angles[k]), int(sides[k])
        known = Candidate(
            angle, side, int(optima.branches[k]), tuple(paths[k, -1]), float(optima.efforts[k]),
            int(optima.refined[k]), OPTIMUM,
        )  # fmt: skip
        found, _ = solve_between_rows_too(task, METHODS[problem.options.method].solve, known)
        if isinstance(found, Candidate) and found.branch is not None:
            angles[k], sides[k] = found.approach_angle_rad, found.tool_side
            branches[k], paths[k, -1] = found.branch, found.thinning_joints
            efforts[k], refined[k] = found.effort, found.iterations
    held = which[branches[which] != NO_BRANCH]
    paths[held] = many_retreat_rows(
        problem.robot,
        problem.mounted_tool,
        paths[held, -1],
        branches[held],
        even_retreats(problem.options),
    )
    return Optima(angles, sides, branches, efforts, paths, np.zeros_like(leaves), refined)


def _vectors(targets: Sequence[Target]) -> tuple[Array, Array]:
    """Positions [m] and branch directions, shape (n, 3) each."""
    positions = np.array([target.position_m for target in targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in targets], dtype=np.float64)
    return positions, directions
