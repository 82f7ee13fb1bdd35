"""What effort is at least in one cell, by hand: joints whose turns at four angles are told."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs.effort_bound import angle_of_cosine, effort_at_least, write_reference
from solver.approach.arcs.turns import TURN_ROWS
from solver.approach.task.constraints import BESIDE, REACH
from solver.approach.task.packed import COLUMNS
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

COLUMNS_OF = (3, 1, 0, 2)
"""Where the four postures stand, each in turns of its own."""


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, 1.5, 3.0, math.pi])
def test_an_angle_from_its_cosine(angle: float) -> None:
    tolerance = 1e-7 if angle in (1e-9, math.pi) else 1e-12
    found = interpreted(angle_of_cosine)(math.cos(angle))
    assert found == pytest.approx(angle, abs=tolerance)
    assert interpreted(angle_of_cosine)(1.0 + 1e-16) == 0.0


def test_the_reference_is_that_of_the_closed_form_s_angles() -> None:
    packed, reference = small_task(2).packed(1), np.full((6, 2), np.nan)
    numbers = packed.numbers.copy()
    offsets, seen_from = np.linspace(-1.0, 2.0, 6), np.linspace(0.3, -0.4, 6)
    numbers[COLUMNS["offsets"] : COLUMNS["offsets"] + 6] = offsets
    numbers[COLUMNS["reference"] : COLUMNS["reference"] + 6] = seen_from
    write_reference(packed._replace(numbers=numbers), reference)
    assert reference[:, 0] == pytest.approx(np.cos(seen_from + offsets), abs=1e-15)
    assert reference[:, 1] == pytest.approx(np.sin(seen_from + offsets), abs=1e-15)


def around(thetas: np.ndarray) -> list[Any]:
    """Turns of joints of given angles, shape (6, 4), within reach, as the kernel is handed them."""
    handed: list[Any] = []
    for own, column in zip(thetas.T, COLUMNS_OF, strict=True):
        turns = np.full((TURN_ROWS, 4), np.nan)
        turns[:12:2, column], turns[1:12:2, column] = np.cos(own), np.sin(own)
        turns[6 + REACH, column] = turns[6 + BESIDE, column] = 0.1
        handed += [turns, column]
    return handed


class ByHand:
    """Joint 6 turns, the others are where the reference is; all are weighed differently."""

    weights = (1.0, 2.0, 0.5, 1.5, 3.0, 5.0)

    def __init__(self, squared: bool) -> None:
        self.squared = squared
        norm = "l2" if squared else "l1"
        self.packed = small_task(2, norm=norm, joint_weights=self.weights).packed(1)

    def cost(self, travel: float, i: int = 5) -> float:
        return self.weights[i] * (travel**2 if self.squared else travel)

    def bound(self, *angles: float, wrist: int = 0, out_of_reach: tuple[int, ...] = (),
              which: int = REACH) -> float:  # fmt: skip
        handed = around(np.array([[0.0] * 4] * 5 + [list(angles)]))
        for k in out_of_reach:
            handed[2 * k][6 + which, COLUMNS_OF[k]] = -0.1
        reference = np.tile([1.0, 0.0], (6, 1))
        return float(effort_at_least(self.packed, reference, wrist, *handed))


@pytest.fixture(params=[False, True], ids=["l1", "l2"])
def hand(request: pytest.FixtureRequest) -> ByHand:
    return ByHand(request.param)


def test_half_of_what_a_turn_changes_is_taken_from_the_nearer_end(hand: ByHand) -> None:
    """From cell to cell, of which the larger of both sides counts; turns are told by their sine."""
    cost, bound, sin = hand.cost, hand.bound, math.sin
    assert bound(0.9, 1.0, 1.1, 1.2) == pytest.approx(cost(1.0))
    assert bound(-0.9, -1.0, -1.1, -1.2) == pytest.approx(cost(1.0))
    assert bound(1.2, 1.1, 1.0, 0.9) == pytest.approx(cost(1.0))
    assert bound(0.6, 1.0, 1.1, 1.2) == pytest.approx(cost(1.0 - (sin(0.4) - sin(0.1)) / 2))
    assert bound(0.9, 1.0, 1.1, 1.5) == pytest.approx(cost(1.0 - (sin(0.4) - sin(0.1)) / 2))
    assert bound(0.6, 1.0, 1.1, 1.3) == pytest.approx(cost(1.0 - (sin(0.4) - sin(0.1)) / 2))
    assert bound(0.9, 1.2, 1.0, 1.1) == pytest.approx(cost(1.0 - (sin(0.3) + sin(0.2)) / 2))
    assert bound(0.0, 0.05, 0.2, 0.2) == 0.0


def test_a_joint_that_passes_its_reference_says_nothing(hand: ByHand) -> None:
    for angles in ((-0.3, -0.1, 0.1, 0.3), (0.6, 0.4, -0.1, -0.6)):
        assert hand.bound(*angles) == 0.0
    # It does if it is the direction behind that it passes.
    behind = [math.pi + angle for angle in (-0.45, -0.15, 0.15, 0.45)]
    assert hand.bound(*behind) == pytest.approx(hand.cost(math.pi - 0.15))


def test_a_joint_that_swings_says_nothing(hand: ByHand) -> None:
    assert hand.bound(0.9, 1.0, 1.9, 2.8) == 0.0
    # Beside the cell it may.
    swings = hand.bound(0.1, 1.0, 1.1, 1.2)
    assert swings == pytest.approx(hand.cost(1.0 - (math.sin(0.9) - math.sin(0.1)) / 2))


@pytest.mark.parametrize("which", [REACH, BESIDE])
@pytest.mark.parametrize(("out", "edge"), [((0, 1), True), ((2, 3), True), ((0,), False),
                                           ((3,), False), ((0, 1, 2, 3), False)])  # fmt: skip
def test_where_the_arm_enters_its_reach_all_that_it_turns_is_taken(
    hand: ByHand, out: tuple[int, ...], edge: bool, which: int
) -> None:
    """In the cell or beside it, whichever is more; the cell alone tells whether it enters."""

    def bound(*angles: float) -> float:
        return hand.bound(*angles, out_of_reach=out, which=which)

    cost, sin = hand.cost, math.sin
    assert bound(0.9, 1.0, 1.1, 1.2) == pytest.approx(cost(0.9 if edge else 1.0))
    one_side = cost(0.6 if edge else 1.0 - (sin(0.4) - sin(0.1)) / 2)
    assert bound(0.6, 1.0, 1.1, 1.2) == pytest.approx(one_side)
    assert bound(0.9, 1.0, 1.1, 1.5) == pytest.approx(one_side)
    inside = cost(0.7 if edge else 1.0 - (sin(0.3) - sin(0.1)) / 2)
    assert bound(0.9, 1.0, 1.3, 1.4) == pytest.approx(inside)
    assert bound(0.9, 1.0, 1.9, 2.8) == 0.0


def test_the_other_wrist_has_its_joints_mirrored(hand: ByHand) -> None:
    """Joints 4 and 6 half a turn further; joint 5, here at its reference of zero, stays."""
    expected = hand.cost(math.pi - 1.1) + hand.cost(math.pi, 3)
    assert hand.bound(0.9, 1.0, 1.1, 1.2, wrist=1) == pytest.approx(expected)


@pytest.mark.parametrize("wrist", [0, 1])
def test_all_joints_count_by_their_weights(hand: ByHand, wrist: int) -> None:
    """Each about an angle of its own, with a reference of its own, a few turns away or none."""
    rng = np.random.default_rng(5)
    for _ in range(50):
        thetas = rng.uniform(-3.0, 3.0, (6, 1)) + np.cumsum(rng.uniform(-0.3, 0.3, (6, 4)), axis=1)
        reference = rng.uniform(-math.pi, math.pi, 6)
        pairs = np.stack((np.cos(reference), np.sin(reference)), axis=1)
        own = thetas.copy()
        if wrist == 1:
            own[[3, 5]] += math.pi
            own[4] *= -1.0
        expected = 0.0
        for i in range(6):
            travel = np.remainder(own[i] - reference[i] + math.pi, 2 * math.pi) - math.pi
            passes = travel[1] * travel[2] < 0.0 and abs(travel[1] - travel[2]) < math.pi
            turns = np.sin(np.diff(own[i]))
            slack = max(abs(turns[1] - turns[0]), abs(turns[2] - turns[1])) / 2
            nearer = min(abs(travel[1]), abs(travel[2]))
            expected += 0.0 if passes else hand.cost(max(nearer - slack, 0.0), i)
        found = effort_at_least(hand.packed, pairs, wrist, *around(thetas))
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)
