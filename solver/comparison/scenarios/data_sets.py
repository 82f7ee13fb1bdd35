"""The thesis's data sets 1 to 3 (T 4.2.1, 4.3.1 and its program), as problems and as contests.

Printed are all of data set 3 and the seventh target of data set 1. The rest is reconstructed from
one rule that fits what T does print: a blossom on every unit of T's model branch, 1.5 cm each, the
first 8.5 cm from the origin, thinned by the 5-8 pattern. Ten blossoms leave 7 targets and 3 that
stay, as in data set 1; eight leave 6 and 2, as in data set 2, where a corner 13.75 cm from the
origin has three targets on each side. With the seventh at y = 17 cm the first is at y = 6.5 cm, and
the fixed z-axis method reaches all of both sets, as T reports; on this line it ends at y = 6 cm, so
that many other spacings are ruled out. Data set 2's place in space is nowhere printed; data set 1's
is taken.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Contest, Published
from solver.problem.problem import Problem
from solver.problem.targets import Target
from solver.problem.thinning import Blossom, BlossomBranch, select_blossoms
from solver.robots.files import load_robot

THESIS: Final = "F. Ouyang, thesis, University of Illinois at Urbana-Champaign, 2012"
PUBLISHED_ON: Final = "MATLAB 7.11 (R2010b); the machine is not named (T 3.2.2)"
INVERSE_S: Final = 0.11
"""T 4.2.2, for finding one inverse kinematics solution [s]."""

FIRST_BLOSSOM_M: Final = 0.085
BLOSSOM_SPACING_M: Final = 0.015
"""A unit of the modular hose that T's branches are made of (T 3.1.3)."""

ORIGIN_M: Final = (0.23, -0.035, 0.315)
"""Of both branches; it puts data set 1's seventh target where T prints it."""
CORNER_M: Final = 0.1375
"""From the origin of data set 2 to its corner: half way between the third and the fourth target."""
LENGTH_M: Final = 0.23

_TIMES_NOTE: Final = (
    "T's times: 0.11 s for one inverse kinematics solution; a target by the fixed z-axis method "
    "0.22 s, for thinning and standby posture; by the floating z-axis method 5.5 s for 50 angles "
    "and 2.2 s for 20 rows of the cut-in, 7.7 s together. Its machine is not named. Times here "
    "contain the rows too."
)
_START_NOTE: Final = "Every target is reached from data set 3's start posture, each on its own."


@dataclass(frozen=True)
class DataSet:
    """One of T's data sets.

    Attributes:
        name: of its scenario.
        title: a line for people.
        origin: what is printed, what is reconstructed.
        tool: the end-effector that T had mounted.
        targets: in T's order.
        published: by method, what T prints a target.
        notes: what readers have to know.
    """

    name: str
    title: str
    origin: str
    tool: str
    targets: tuple[Target, ...]
    published: dict[str, Published]
    notes: tuple[str, ...]

    def problem(self) -> Problem:
        """The targets for the table-top arm with this data set's tool."""
        return Problem(load_robot("tabletop"), self.targets, tool=self.tool)


def data_set_1() -> DataSet:
    """A horizontal branch across the arm: ten blossoms, seven targets."""
    x, y, z = ORIGIN_M
    return DataSet(
        name="data-set-1",
        title="The thesis's data set 1: a horizontal branch, seven targets",
        origin=f"{THESIS}, 4.2.1 and 4.2.2. Printed: the branch along (0, 1, 0), 7 targets of 10 "
        "blossoms by the 5-8 pattern, the seventh at (23, 17, 31.5) cm, and the tool. "
        "RECONSTRUCTED: targets 1 to 6, from a blossom every 1.5 cm, the first 8.5 cm from an "
        "origin at y = -3.5 cm.",
        tool="scaffold",
        targets=reconstructed([ORIGIN_M, (x, y + LENGTH_M, z)], 10),
        published={"fixed_z": Published(time_s=2 * INVERSE_S)},
        notes=(
            "T: the first six targets were reached; on its way to the seventh the end-effector, "
            "moved without rows between standby and thinning, bumped into the branch.",
            _START_NOTE,
            _TIMES_NOTE,
        ),
    )


def data_set_2() -> DataSet:
    """A horizontal and a leaning segment: eight blossoms, six targets."""
    x, y, z = ORIGIN_M
    corner = (x, y + CORNER_M, z)
    rise = (LENGTH_M - CORNER_M) / math.sqrt(2)
    tip = (x, corner[1] + rise, z + rise)
    return DataSet(
        name="data-set-2",
        title="The thesis's data set 2: a horizontal and a leaning segment, six targets",
        origin=f"{THESIS}, 4.2.1. Printed: a horizontal segment and one that leans from it by 45 "
        "degrees, both normal to the x axis; 6 targets of 8 blossoms, three on each segment; the "
        "tool. RECONSTRUCTED: every coordinate. Origin and blossoms as in data set 1, the corner "
        "13.75 cm from the origin; the second segment leans upwards.",
        tool="scaffold",
        targets=reconstructed([ORIGIN_M, corner, tip], 8),
        published={"fixed_z": Published(time_s=2 * INVERSE_S)},
        notes=("T: all targets were visited smoothly.", _START_NOTE, _TIMES_NOTE),
    )


def data_set_3() -> DataSet:
    """A branch in space, higher than the arm: five targets."""
    return DataSet(
        name="data-set-3",
        title="The thesis's data set 3: a branch in space, five targets",
        origin=f"{THESIS}, program listing (cm there). All coordinates and directions are printed.",
        tool="laser",
        targets=(
            Target("1", (0.185, -0.057, 0.420), (-1, -1, 1)),
            Target("2", (0.180, -0.070, 0.425), (-1, -1, 1)),
            Target("3", (0.160, -0.083, 0.435), (-1, -1, 0)),
            Target("4", (0.150, -0.089, 0.445), (-1, -1, 0)),
            Target("5", (0.140, -0.095, 0.450), (-1, -1, 0)),
        ),
        published={"floating_z": Published(time_s=70 * INVERSE_S)},
        notes=(
            "T: the fixed z-axis method cannot be used, as the branch leans out of the plane "
            "normal to the x axis; the floating one visited all five.",
            "T's text has the second segment along (-1, 1, 1), its program along (-1, -1, 1); the "
            "program's is taken. Steps between targets do not follow the directions, on purpose.",
            _START_NOTE,
            _TIMES_NOTE,
        ),
    )


def reconstructed(
    points: Sequence[tuple[float, float, float]], blossoms: int
) -> tuple[Target, ...]:
    """Targets along a polyline [m] by the 5-8 pattern, numbered from its origin."""
    along = [Blossom(str(k), FIRST_BLOSSOM_M + k * BLOSSOM_SPACING_M) for k in range(blossoms)]
    chosen_blossoms = select_blossoms([BlossomBranch("branch", points, along)]).targets
    return tuple(
        Target(str(number), one.position_m, one.branch_direction)
        for number, one in enumerate(chosen_blossoms, start=1)
    )


def data_set_1_contest(methods: Sequence[str] | None) -> Contest:
    """The contest of data set 1; see `contest_of` for errors."""
    return contest_of(data_set_1(), methods)


def data_set_2_contest(methods: Sequence[str] | None) -> Contest:
    """The contest of data set 2; see `contest_of` for errors."""
    return contest_of(data_set_2(), methods)


def data_set_3_contest(methods: Sequence[str] | None) -> Contest:
    """The contest of data set 3; see `contest_of` for errors."""
    return contest_of(data_set_3(), methods)


def contest_of(data_set: DataSet, methods: Sequence[str] | None) -> Contest:
    """The contest of a data set between methods; None: all of them.

    Raises:
        UnknownEntrant: there is no such method.
    """
    problem = data_set.problem()
    published = {
        (target.id, method): figure
        for target in data_set.targets
        for method, figure in data_set.published.items()
    }
    return approach_contest(
        problem,
        chosen(method_variants(problem), methods),
        scenario=data_set.name,
        title=data_set.title,
        origin=data_set.origin,
        notes=data_set.notes,
        published=published,
        published_on=PUBLISHED_ON,
    )
