import math

import pytest

from solver import Robot, solve
from tests.solver.problems import data_set_3


def test_angles_are_those_of_the_thesis_grid(tabletop: Robot) -> None:
    plan = solve(data_set_3(tabletop, method="floating_z", samples=50))
    assert plan.planned == 5
    for approach in plan.approaches:
        assert approach.approach_angle_rad is not None
        step = (approach.approach_angle_rad + math.pi) / (2 * math.pi / 50)
        assert step == pytest.approx(round(step), abs=1e-9)


def test_few_samples_fail_and_more_samples_cost_less(tabletop: Robot) -> None:
    """T 4.3.2: n = 10 and 20 failed frequently; here a single angle does."""
    alone = solve(data_set_3(tabletop, method="floating_z", samples=1, order="independent"))
    assert alone.planned == 0
    reasons = [approach.reason for approach in alone.approaches]
    assert all(reason is not None for reason in reasons)
    efforts = [
        solve(data_set_3(tabletop, method="floating_z", samples=n, order="independent"))
        for n in (50, 500)
    ]
    best = solve(data_set_3(tabletop, method="ssas", order="independent"))
    assert best.total_effort <= efforts[1].total_effort <= efforts[0].total_effort
