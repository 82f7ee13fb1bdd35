import math

import pytest

from app.schemas.demo_request import demo_request
from solver.comparison.approach_contest import Answer
from solver.comparison.contest import Contest
from solver.comparison.scenarios.data_sets import (
    data_set_1,
    data_set_1_contest,
    data_set_2,
    data_set_2_contest,
    data_set_3,
    data_set_3_contest,
)


def solved(contest: Contest, name: str) -> list[bool]:
    (entrant,) = (one for one in contest.entrants if one.name == name)
    answers: list[Answer] = [entrant.solve(k) for k in range(len(contest.target_ids))]
    return [contest.account(name, k, answer).solved for k, answer in enumerate(answers)]


def test_data_set_1_is_as_far_as_it_is_printed() -> None:
    """T 4.2.1, 4.2.2: seven targets along (0, 1, 0), the seventh at (23, 17, 31.5) cm."""
    targets = data_set_1().targets
    assert [target.id for target in targets] == list("1234567")
    assert targets[6].position_m == pytest.approx((0.23, 0.17, 0.315), abs=1e-12)
    assert all(target.branch_direction == (0.0, 1.0, 0.0) for target in targets)
    assert data_set_1().problem().mounted_tool.name == "scaffold"


def test_data_set_2_is_as_far_as_it_is_printed() -> None:
    """T 4.2.1: three targets on a horizontal segment and three on one that leans by 45 degrees."""
    targets = data_set_2().targets
    level, leaning = targets[:3], targets[3:]
    assert len(leaning) == 3
    assert all(target.branch_direction == (0.0, 1.0, 0.0) for target in level)
    for target in leaning:
        assert target.branch_direction == pytest.approx((0.0, math.sqrt(0.5), math.sqrt(0.5)))
    assert data_set_2().problem().mounted_tool.name == "scaffold"


def test_data_set_3_is_the_demonstration() -> None:
    printed = demo_request()["targets"]
    targets = data_set_3().targets
    assert [list(target.position_m) for target in targets] == [one["position_m"] for one in printed]
    assert [list(target.branch_direction) for target in targets] == [
        one["branch_direction"] for one in printed
    ]
    assert data_set_3().problem().mounted_tool.name == "laser"


def test_methods_reach_what_the_thesis_reached_with_them() -> None:
    assert all(solved(data_set_1_contest(["fixed_z"]), "fixed_z"))
    assert all(solved(data_set_2_contest(["fixed_z"]), "fixed_z"))
    assert not any(solved(data_set_3_contest(["fixed_z"]), "fixed_z"))
    assert all(solved(data_set_3_contest(["floating_z"]), "floating_z"))


def test_published_times() -> None:
    """T 4.2.2 and 4.3.2."""
    contest = data_set_3_contest(None)
    times = [contest.published[target, "floating_z"].time_s for target in contest.target_ids]
    assert times == [pytest.approx(7.7)] * 5
    first = data_set_1_contest(None)
    assert first.published["7", "fixed_z"].time_s == pytest.approx(0.22)
    notes = " ".join(contest.notes)
    assert all(figure in notes for figure in ("0.11 s", "5.5 s", "7.7 s"))
    assert "not named" in contest.published_on
