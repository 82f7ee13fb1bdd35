"""`workspace`: random targets that the table-top arm can reach."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Contest
from solver.comparison.targets import as_targets, drawn_in_box
from solver.problem.problem import Problem
from solver.problem.targets import Target
from solver.robots.files import load_robot

SEED: Final = 20_121
TARGETS: Final = 50
DRAWN: Final = 220
"""Enough to find them: nearly half of the box has an approach."""


def workspace_problem(seed: int = SEED, count: int = TARGETS) -> Problem:
    """The first targets drawn from the box for which the closed form has an approach.

    Raises:
        ValueError: too few of those drawn have one.
    """
    robot = load_robot("tabletop")
    positions, directions = drawn_in_box(seed, max(DRAWN, 5 * count))
    probe = Problem(robot, [Target("probe", (0.2, 0.0, 0.3), (0.0, 1.0, 0.0))])
    found = closed_form_optima(probe, positions, directions, np.asarray(probe.start))
    reached = np.flatnonzero(found.branches != NO_BRANCH)[:count].tolist()
    if len(reached) < count:
        raise ValueError(f"seed {seed}: {len(reached)} targets can be reached, wanted {count}")
    return Problem(robot, as_targets(positions, directions, reached))


def workspace_contest(methods: Sequence[str] | None) -> Contest:
    """The contest; None: all methods.

    Raises:
        UnknownEntrant: there is no such method.
    """
    problem = workspace_problem()
    return approach_contest(
        problem,
        chosen(method_variants(problem), methods),
        scenario="workspace",
        title=f"{TARGETS} random targets that the table-top arm can reach",
        origin="Drawn evenly from a box in front of the arm, 5 to 38 cm ahead, 30 cm to each side, "
        "5 to 50 cm high, branches in every direction; those without an approach are left out.",
        notes=(
            "fixed_z refuses all of them: their branches lean out of the one plane that it knows.",
        ),
        seeds=(SEED,),
    )
