"""`fixed-or-floating`: the fixed against the floating z-axis method, where both apply (T 5.1)."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Account, Contest
from solver.comparison.scenarios.data_sets import THESIS
from solver.comparison.targets import as_targets, drawn_in_box
from solver.problem.problem import Problem
from solver.robots.files import load_robot

SEED: Final = 20_124
TARGETS: Final = 100
ENTRANTS: Final = ("fixed_z", "floating_z", "ncos")


def fixed_or_floating_problem(seed: int = SEED, count: int = TARGETS) -> Problem:
    """Targets anywhere in the box, on branches normal to the world's x axis, as fixed_z wants them.

    They are taken as drawn, reachable or not: the question is how much of the space a method loses.
    """
    positions, directions = drawn_in_box(seed, count)
    across = directions * np.array([0.0, 1.0, 1.0])
    return Problem(load_robot("tabletop"), as_targets(positions, across, range(count)))


def fixed_or_floating_contest(methods: Sequence[str] | None) -> Contest:
    """The contest; None: fixed_z, floating_z and ncos.

    Raises:
        UnknownEntrant: there is no such method.
    """
    problem = fixed_or_floating_problem()
    names = ENTRANTS if methods is None else methods
    return approach_contest(
        problem,
        chosen(method_variants(problem), names),
        scenario="fixed-or-floating",
        title=f"Fixed or floating z axis: {TARGETS} targets on branches that suit both",
        origin=f"{THESIS}, 4.2 and 5.1. Targets drawn evenly from a box in front of the arm, "
        "branches in every direction normal to the x axis; none is left out.",
        notes=(
            'T: "the fixed orientation of the tool frame imposed a strict limitation on the '
            'manipulator and greatly reduced its operational space".',
        ),
        seeds=(SEED,),
        findings=_findings,
    )


def _findings(accounts: Mapping[tuple[str, str], Account]) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(entrant for _, entrant in accounts))
    told = [f"{name} reaches {_solved(name, accounts)} targets." for name in names]
    if not {"fixed_z", "floating_z"} <= set(names):
        return tuple(told)
    ratios = []
    for (target, name), fixed in accounts.items():
        floating = accounts[target, "floating_z"]
        if name == "fixed_z" and fixed.index is not None and floating.index is not None:
            ratios.append(floating.index / fixed.index)
    if ratios:
        saved = 100 * (1 - math.exp(float(np.mean(np.log(ratios)))))
        told.append(
            f"Where both reach, the floating axis takes {saved:.0f} % less effort on average "
            f"(geometric mean of {len(ratios)} targets)."
        )
    return tuple(told)


def _solved(name: str, accounts: Mapping[tuple[str, str], Account]) -> int:
    return sum(account.solved for (_, entrant), account in accounts.items() if entrant == name)
