"""Tolerances that rooms of approaches share, in the units in which their reasons speak."""

import math

import pytest

from solver.approach.arcs.tolerances import CELL_SWING_COSINE
from solver.approach.tolerances import (
    ANGLE_STEP_RAD,
    ARC_CELLS,
    EXCHANGE_DENSITY,
    LEAST_EFFORT_CELLS,
    UNCERTAINTY_DEVIATIONS,
)


def test_cells_are_five_degrees_and_halved_where_a_joint_swings_by_more() -> None:
    assert 360 / ARC_CELLS == 5.0
    assert math.acos(CELL_SWING_COSINE) == pytest.approx(0.8, abs=0.01)
    assert LEAST_EFFORT_CELLS == 4


def test_three_deviations_hold_all_but_a_few_targets() -> None:
    """99.87 % are on the feasible side of a flat limit, 97 % in the whole ball."""
    d = UNCERTAINTY_DEVIATIONS
    side = (1 + math.erf(d / math.sqrt(2))) / 2
    ball = math.erf(d / math.sqrt(2)) - math.sqrt(2 / math.pi) * d * math.exp(-d * d / 2)
    assert side == pytest.approx(0.9987, abs=5e-5)
    assert ball == pytest.approx(0.97, abs=2e-3)


def test_an_angle_is_closed_in_on_far_below_what_a_cell_tells() -> None:
    assert pytest.approx(1e-10) == ANGLE_STEP_RAD
    assert EXCHANGE_DENSITY == 8
