"""`sample-counts`: how many angles the floating z-axis method needs (T 4.3.2)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.comparison.approach_contest import (
    Variant,
    approach_contest,
    chosen,
    comparable,
    method_variants,
)
from solver.comparison.contest import Account, Contest
from solver.comparison.scenarios.data_sets import THESIS, data_set_3
from solver.comparison.scenarios.near_limits import near_limits_problem
from solver.methods.any_arm import Solve, on_any_arm
from solver.methods.floating_z import solve_floating_z
from solver.problem.problem import Problem
from solver.problem.solution import Reason

SEED: Final = 20_123
STARTS: Final = 20
COUNTS: Final = (10, 20, 30, 40, 50)
NARROW_TARGETS: Final = 5
"""Targets with little room, beside data set 3's, which are reached from every start."""
NARROW: Final = "narrow "
START: Final = ", start "
"""Parts of target ids: which kind of target it is, and which random start."""


def sample_counts_problem() -> Problem:
    """Data set 3's targets and some of `near-limits`, each once for every random start."""
    problem = data_set_3().problem()
    narrow = near_limits_problem(count=NARROW_TARGETS).targets
    targets = [replace(one, id=f"{NARROW}{one.id}") for one in narrow]
    return replace(
        problem,
        targets=[
            replace(target, id=f"{target.id}{START}{start:02}")
            for target in (*problem.targets, *targets)
            for start in range(1, STARTS + 1)
        ],
    )


def sample_counts_contest(methods: Sequence[str] | None) -> Contest:
    """The contest of numbers of angles, and `ncos` beside them; None: all of these.

    Raises:
        UnknownEntrant: there is no such entrant.
    """
    problem = sample_counts_problem()
    draws = np.random.default_rng(SEED).uniform(0.0, 2 * math.pi, len(problem.targets))
    phases = {target.id: float(phase) for target, phase in zip(problem.targets, draws, strict=True)}
    variants = [
        Variant(
            f"floating_z n={count}",
            f"{count} angles from a random start (T 3.4.2)",
            comparable(problem, method="floating_z", samples=count),
            _from_random_start(phases),
        )
        for count in COUNTS
    ]
    ncos = next(variant for variant in method_variants(problem) if variant.name == "ncos")
    return approach_contest(
        problem,
        chosen([*variants, ncos], methods),
        scenario="sample-counts",
        title=f"Numbers of sampled angles, each from {STARTS} random starts",
        origin=f"{THESIS}, 4.3.2, on its data set 3, and on {NARROW_TARGETS} targets of "
        "near-limits; the start of the angles is drawn anew for each row, as T draws it.",
        notes=(
            "T: n = 10 and 20 failed frequently; with 30 and 40 the repeatability was low; with 50 "
            "results were accepted.",
            "T plans its five targets in a chain, so that differences add up; here each starts "
            "from the start posture, so that what is seen is the sampling alone.",
        ),
        seeds=(SEED,),
        findings=_findings,
    )


def _from_random_start(phases: Mapping[str, float]) -> Solve:
    def solve(task: ApproachTask) -> Candidate | Reason:
        return solve_floating_z(task, phases[task.target.id])

    return on_any_arm(solve)


def _findings(accounts: Mapping[tuple[str, str], Account]) -> tuple[str, ...]:
    names = dict.fromkeys(name for _, name in accounts)
    return tuple(
        f"{name}: {_told(own(accounts, name, narrow=False))} on data set 3; "
        f"{_told(own(accounts, name, narrow=True))} on targets with little room."
        for name in names
    )


def own(
    accounts: Mapping[tuple[str, str], Account], name: str, *, narrow: bool
) -> dict[str, list[Account]]:
    """An entrant's accounts of all starts by target, of data set 3 or of those with little room."""
    found: dict[str, list[Account]] = {}
    for (target, entrant), account in accounts.items():
        if entrant == name and target.startswith(NARROW) == narrow:
            found.setdefault(target.rpartition(START)[0], []).append(account)
    return found


def _told(by_target: Mapping[str, Sequence[Account]]) -> str:
    """How often an entrant failed, and how far its answers for one target lie apart."""
    every = [account for found in by_target.values() for account in found]
    told = f"{sum(not account.solved for account in every)} of {len(every)} failed"
    solved = [[one for one in found if one.solved] for found in by_target.values()]
    spreads = [_spread(found) for found in solved if len(found) > 1]
    if not spreads:
        return told
    effort, joint = max(one for one, _ in spreads), max(two for _, two in spreads)
    return (
        f"{told}, efforts for one target differ by up to {effort:.3f} rad and a joint by up to "
        f"{math.degrees(joint):.1f} degrees"
    )


def _spread(found: Sequence[Account]) -> tuple[float, float]:
    efforts = [account.index for account in found if account.index is not None]
    postures = np.array([account.joints for account in found])
    return max(efforts) - min(efforts), float(np.ptp(postures, axis=0).max())
