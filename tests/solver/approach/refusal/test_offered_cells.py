"""Offers on one target: the cell of the angle tells what all arcs tell."""

import math

import numpy as np
import pytest

from solver.approach.arcs.arcs import task_arcs
from solver.approach.refusal.nearest_change import _on_an_arc, _same_direction, displaced
from solver.approach.refusal.offered import offer_holds, on_an_arc
from tests.solver.methods.synthetic import small_task

TASK = small_task(2)
ARCS = task_arcs(TASK)


@pytest.mark.parametrize("k", range(len(ARCS)))
def test_an_angle_is_on_an_arc_of_its_branch_alone(k: int) -> None:
    arc, packed = ARCS[k], TASK.packed(1)
    middle = (arc.lower_rad + arc.upper_rad) / 2
    spots = [middle, arc.lower_rad - 1e-6, arc.lower_rad + 1e-6, arc.upper_rad + 1e-6]
    turned = [math.remainder(spot, 2 * math.pi) for spot in spots]
    found = [bool(on_an_arc(packed, arc.branch, one)) for one in turned]
    assert found == [True, False, True, False]
    for other in range(8):
        expected = any(
            one.branch == other
            and (turned[0] - one.lower_rad) % (2 * math.pi) <= one.upper_rad - one.lower_rad
            for one in ARCS
        )
        assert on_an_arc(packed, other, turned[0]) == expected


def test_what_is_known_of_another_task_is_forgotten() -> None:
    """Asked again and again, of places far from feasible as well."""
    packed, arc = TASK.packed(1), ARCS[0]
    far = packed.numbers.copy()
    far[:] = packed.numbers
    middle = math.remainder((arc.lower_rad + arc.upper_rad) / 2, 2 * math.pi)
    for _ in range(2):
        assert on_an_arc(packed, arc.branch, middle)
        assert not on_an_arc(packed, 7 - arc.branch, -3.1)


@pytest.mark.parametrize("angle", [-1.0, 0.0, 0.2, 0.5, 1.2])
def test_an_offer_is_looked_at_where_it_is_displaced_to(angle: float) -> None:
    shift = np.array([0.004, -0.003, 0.002])
    moved = displaced(TASK, (0.004, -0.003, 0.002))
    turn = TASK.robot.mount[:3, :3].T
    kernels, packed = TASK.for_kernels(1), TASK.packed(1)
    before = kernels.position.copy(), packed.numbers.copy()
    inside, closer = offer_holds(kernels, packed, 2, np.append(turn @ shift, angle))
    own = _same_direction(TASK, tuple(moved.target.position_m), angle)
    assert inside == _on_an_arc(moved, own, 1, 2)
    assert not (inside and closer)
    assert np.array_equal(kernels.position, before[0])
    assert np.array_equal(packed.numbers, before[1])


def test_an_offer_beside_a_limit_is_looked_at_more_closely() -> None:
    """Where a joint turns back between rows just at its limit."""
    closer = []
    for arc in ARCS:
        for end in (arc.lower_rad + 1e-9, arc.upper_rad - 1e-9):
            x = np.array([0.0, 0.0, 0.0, end])
            inside, look = offer_holds(TASK.for_kernels(1), TASK.packed(1), arc.branch, x)
            assert inside
            closer.append(bool(look))
    assert len(closer) == 2 * len(ARCS)
