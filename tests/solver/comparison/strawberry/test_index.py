import numpy as np
import pytest
from hypothesis import given

from solver.comparison.strawberry.index import (
    energy_index,
    friction_loss,
    potential_rise,
    printed_index,
)
from solver.comparison.strawberry.mechanism import Posture, link_points
from tests.solver.comparison.strawberry.places import MECHANISM, postures


def height_energy(posture: Posture) -> float:
    """S (19) and (20) from the links' places: m2 half-way along DE, m3 half-way along EP [J]."""
    _, _, shoulder, elbow, tip = link_points(MECHANISM, posture)
    tip_n = MECHANISM.tip_weight_n
    lower_n = MECHANISM.lifted_n - tip_n
    return float(lower_n * (shoulder[2] + elbow[2]) / 2 + tip_n * (elbow[2] + tip[2]) / 2)


@given(postures)
def test_potential_energy_is_that_of_the_links_heights(posture: Posture) -> None:
    expected = height_energy(posture) - height_energy(MECHANISM.reset)
    assert potential_rise(MECHANISM, posture) == pytest.approx(expected, abs=1e-12)


@given(postures)
def test_the_two_signs_differ_by_the_potential_energy_alone(posture: Posture) -> None:
    assert energy_index(MECHANISM, posture) + printed_index(MECHANISM, posture) == pytest.approx(
        2 * friction_loss(MECHANISM, posture), abs=1e-12
    )
    assert friction_loss(MECHANISM, posture) >= 0.0


def test_the_reset_costs_nothing() -> None:
    assert energy_index(MECHANISM, MECHANISM.reset) == 0.0


def test_slopes_along_the_slides_are_those_identified_from_table_3() -> None:
    """9.81 N along x and y, 24.525 N downwards."""
    reset = np.array(MECHANISM.reset)
    costs = []
    for slide in range(3):
        moved = reset.copy()
        moved[slide] += 0.1
        costs.append(energy_index(MECHANISM, Posture(*moved.tolist())) / 0.1)
    assert costs == pytest.approx([9.81, 9.81, 24.525])
