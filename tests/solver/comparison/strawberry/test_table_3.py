"""The table as printed agrees with itself, and with what is said to follow from it."""

import math

import numpy as np
import pytest

from solver.comparison.strawberry.table_3 import PLANT_CENTRE_M, PLANT_RADIUS_M, Row, table_3
from tests.solver.comparison.strawberry.places import MECHANISM

ROWS = table_3()


def test_it_has_twenty_targets() -> None:
    assert len({row.label for row in ROWS}) == len(ROWS) == 20


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.label)
def test_printed_percentages_follow_from_the_printed_numbers(row: Row) -> None:
    for method in ("ssas", "as"):
        index, time = row.index_n_mm, row.time_s
        increase = 100 * (index[method] / index["ncos"] - 1)
        reduction = 100 * (1 - time[method] / time["ncos"])
        assert increase == pytest.approx(row.increase_pct[method], abs=0.01)
        assert reduction == pytest.approx(row.reduction_pct[method], abs=0.01)


def test_printed_mean_times_are_those_of_the_text() -> None:
    """S section 4: 15.1 ms and 567.7 ms."""
    assert np.mean([row.time_s["as"] for row in ROWS]) == pytest.approx(0.0151, abs=5e-5)
    assert np.mean([row.time_s["ncos"] for row in ROWS]) == pytest.approx(0.5677, abs=6e-5)


def test_targets_lie_on_a_sphere_below_the_middle_of_the_table() -> None:
    """With z printed to a tenth of a millimetre, rounded or cut off."""
    for row in ROWS:
        x, y, z = row.target
        across = math.hypot(x - PLANT_CENTRE_M[0], y - PLANT_CENTRE_M[1])
        exact = PLANT_CENTRE_M[2] + math.sqrt(PLANT_RADIUS_M**2 - across**2)
        assert abs(z - exact) < 1e-4
    for middle, span in zip(PLANT_CENTRE_M, (MECHANISM.s21, MECHANISM.s10), strict=False):
        assert middle == pytest.approx((span.lower + span.upper) / 2)


def test_ssas_less_ncos_is_a_constant_in_each_quadrant_of_the_plant() -> None:
    """And not the same, which no choice of the unknowns gives (docs/strawberry.md)."""
    quadrants: dict[tuple[bool, bool], list[float]] = {}
    for row in ROWS:
        place = (row.target[0] > PLANT_CENTRE_M[0], row.target[1] > PLANT_CENTRE_M[1])
        apart = row.index_n_mm["ssas"] - row.index_n_mm["ncos"]
        quadrants.setdefault(place, []).append(apart)
    assert [len(values) for values in quadrants.values()] == [5, 5, 5, 5]
    assert all(np.ptp(values) <= 0.2 + 1e-9 for values in quadrants.values())
    means = sorted(float(np.mean(values)) for values in quadrants.values())
    assert means == pytest.approx([370.0, 376.4, 392.9, 399.6], abs=0.05)
