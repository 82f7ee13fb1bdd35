"""`kac-v`: the thesis's metre-high model tree, its branches thinned by the 5-8 pattern.

From T 3.1.1 and 3.1.3: 1 m high; two scaffolds, leaning 30 and 40 degrees from the vertical; about
30 fruiting branches on each, from horizontal (90 degrees off the vertical) to nearly vertical (10).
The plane of the scaffolds is normal to the rows of the orchard ("perpendicular V"). The rest is
assumed, for T's drawing (its figure A.1) did not survive: the constants below say what.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Contest
from solver.comparison.scenarios.data_sets import BLOSSOM_SPACING_M, THESIS
from solver.problem.problem import Problem
from solver.problem.targets import Target
from solver.problem.thinning import Blossom, BlossomBranch, PlacedBlossom, select_blossoms
from solver.robots.files import load_robot
from solver.robots.model import Array

HEIGHT_M: Final = 1.0
LEANS_DEG: Final = (-30.0, 40.0)
"""Of the scaffolds from the vertical; below zero towards the arm, which works on that one."""
BRANCHES_EACH: Final = 30
STEEPNESS_DEG: Final = (90.0, 10.0)
"""Of the lowest and the highest branch from the vertical; evenly between them in between."""
BASE_TO_TRUNK_M: Final = 0.25
"""From the arm's base to the trunk, along x."""
WITHIN_REACHES: Final = 2.0
"""Targets further than so many times the reach from the base are no concern of an arm that stands
there."""

FORK_M: Final = 0.2
"""Assumed: height at which the trunk divides."""
BRANCH_M: Final = 0.23
"""Assumed: a fruiting branch's length, as in data sets 1 and 2."""
TURN_DEG: Final = 144.0
"""Assumed: from branch to branch about the vertical, two fifths of a turn as with buds."""
SPACING_M: Final = 2 * BLOSSOM_SPACING_M
"""Assumed: a blossom on every second unit of T's model branches, the first on the first."""
TOOL: Final = "scaffold"
"""T's end-effector as its data sets 1 and 2 have it."""


def kac_v_branches() -> tuple[BlossomBranch, ...]:
    """The fruiting branches in the arm's base frame, straight, with a blossom every 3 cm."""
    steepness = np.radians(np.linspace(*STEEPNESS_DEG, BRANCHES_EACH))
    along = np.arange(BLOSSOM_SPACING_M / 2, BRANCH_M, SPACING_M).tolist()
    branches = []
    for scaffold, lean in enumerate(np.radians(LEANS_DEG), start=1):
        for k in range(BRANCHES_EACH):
            origin = _on_scaffold(float(lean), (k + 0.5) / BRANCHES_EACH)
            tip = origin + BRANCH_M * _direction(float(steepness[k]), math.radians(k * TURN_DEG))
            name = f"{scaffold}-{k + 1:02}"
            blossoms = [
                Blossom(f"{name}-{number}", distance)
                for number, distance in enumerate(along, start=1)
            ]
            branches.append(BlossomBranch(name, (_point(origin), _point(tip)), blossoms))
    return tuple(branches)


def _on_scaffold(lean: float, share: float) -> Array:
    height = FORK_M + share * (HEIGHT_M - FORK_M)
    return np.array([BASE_TO_TRUNK_M + (height - FORK_M) * math.tan(lean), 0.0, height])


def _direction(from_vertical: float, about_vertical: float) -> Array:
    across = math.sin(from_vertical)
    return np.array(
        [
            across * math.cos(about_vertical),
            across * math.sin(about_vertical),
            math.cos(from_vertical),
        ]
    )


def _point(place: Array) -> tuple[float, float, float]:
    x, y, z = place.tolist()
    return x, y, z


def kac_v_problem() -> Problem:
    """What the 5-8 pattern removes within twice the reach, for the table-top arm."""
    robot = load_robot("tabletop")
    tool = robot.tool(TOOL)
    assert tool is not None, "it ships with the model"
    within_m = WITHIN_REACHES * robot.reach_m(tool)
    removed = select_blossoms(kac_v_branches()).targets
    near = [one for one in removed if math.hypot(*one.position_m) <= within_m]
    return Problem(robot, [_target(one) for one in near], tool=tool)


def _target(blossom: PlacedBlossom) -> Target:
    return Target(blossom.id, blossom.position_m, blossom.branch_direction)


def kac_v_contest(methods: Sequence[str] | None) -> Contest:
    """The contest; None: all methods.

    Raises:
        UnknownEntrant: there is no such method.
    """
    problem = kac_v_problem()
    removed = len(select_blossoms(kac_v_branches()).targets)
    return approach_contest(
        problem,
        chosen(method_variants(problem), methods),
        scenario="kac-v",
        title="The thesis's metre-high model tree, thinned by the 5-8 pattern",
        origin=f"{THESIS}, 3.1.1 and 3.1.3: height 1 m, scaffolds at 30 and 40 degrees, about 30 "
        "fruiting branches each from horizontal to nearly vertical. ASSUMED, as the drawing did "
        "not survive: the trunk divides at 0.2 m, the scaffold at 30 degrees leans towards the "
        "arm, branches are straight, 23 cm long and turn by 144 degrees from one to the next, a "
        "blossom every 3 cm.",
        notes=(
            f"The base is {BASE_TO_TRUNK_M:g} m from the trunk. The pattern removes {removed} "
            f"blossoms; the {len(problem.targets)} within twice the reach are targets. What is out "
            "of reach from where the base stands is refused, and counts as such.",
            "The tree is no obstacle here: each target is planned as if alone.",
        ),
    )
