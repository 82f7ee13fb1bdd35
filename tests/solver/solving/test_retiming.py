"""Chosen approaches get the planner's own motion again, or none."""

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Approach, Options, Plan, Problem, Robot, Target, load_robot, solve, verify
from solver.exceptions import RetimingFailed
from solver.problem.options import MethodName
from solver.solving.retiming import ChosenApproach, retime
from tests.solver.problems import DATA_SET_3, data_set_3, random_targets


def chosen(plan: Plan) -> list[ChosenApproach]:
    return [choice(approach) for approach in plan.approaches if approach.status == "planned"]


def choice(approach: Approach) -> ChosenApproach:
    """As it is after a way through JSON: plain numbers."""
    assert approach.approach_angle_rad is not None
    assert approach.tool_side is not None
    assert approach.branch is not None
    return ChosenApproach(
        approach.target_id,
        approach.approach_angle_rad,
        approach.tool_side,
        approach.branch,
        np.asarray(approach.standby_joints).tolist(),
        np.asarray(approach.thinning_joints).tolist(),
    )


@pytest.mark.parametrize("method", ["floating_z", "ssas", "ncos"])
def test_order_given_has_the_trajectories_of_the_plan(tabletop: Robot, method: MethodName) -> None:
    far = Target("far", (0.0, 2.0, 0.1), (0, 0, 1))
    targets = (DATA_SET_3[0], far, *DATA_SET_3[1:])
    plan = solve(Problem(tabletop, targets, options=Options(method=method)))
    planned = [approach for approach in plan.approaches if approach.status == "planned"]
    again = retime(plan.problem, chosen(plan))
    assert len(again) == len(planned) == 5
    for old, new in zip(planned, again, strict=True):
        assert old.trajectory is not None
        assert new.trajectory is not None
        assert new.status == "planned"
        np.testing.assert_array_equal(new.trajectory.times_s, old.trajectory.times_s)
        np.testing.assert_array_equal(new.trajectory.joints, old.trajectory.joints)
        assert new.trajectory.segments == old.trajectory.segments
        assert new.effort == old.effort


def test_order_independent_becomes_one_continuous_motion(tabletop: Robot) -> None:
    targets = random_targets(seed=51, count=40)
    options = Options(method="ssas", order="independent", symmetric_tool=True)
    plan = solve(Problem(tabletop, targets, options=options))
    again = retime(plan.problem, chosen(plan))
    assert len(again) == plan.planned >= 10
    before = np.asarray(plan.problem.start)
    for approach in again:
        assert approach.trajectory is not None
        np.testing.assert_array_equal(approach.trajectory.joints[0], before)
        assert verify(plan.problem, approach, tuple(before)).accepted
        before = np.asarray(approach.standby_joints)
        np.testing.assert_allclose(approach.trajectory.joints[-1], before, rtol=0, atol=1e-9)


def test_relaxed_approaches_are_rebuilt(tabletop: Robot) -> None:
    plan = solve(data_set_3(tabletop, strike_zone_m=0.02, tilt_tolerance_rad=0.15))
    assert plan.planned == 5
    for before, after in zip(plan.approaches, retime(plan.problem, chosen(plan)), strict=True):
        assert after.status == "planned"
        assert (after.strike_m, after.tilt_rad) == (before.strike_m, before.tilt_rad)
        assert before.trajectory is not None
        assert after.trajectory is not None
        np.testing.assert_allclose(after.trajectory.joints, before.trajectory.joints, atol=1e-9)


def test_another_order_is_continuous_too(tabletop: Robot) -> None:
    plan = solve(data_set_3(tabletop, method="ssas"))
    again = retime(plan.problem, chosen(plan)[::-1])
    assert [approach.target_id for approach in again] == list("54321")


@pytest.fixture(scope="module")
def plan() -> Plan:
    return solve(data_set_3(load_robot("tabletop"), method="ssas"))


def _moved(values: Any, joint: int, amount: float) -> list[float]:
    moved = list(values)
    moved[joint] += amount
    return moved


TAMPERED: dict[str, Any] = {
    "angle": lambda c: replace(c, approach_angle_rad=c.approach_angle_rad + 1e-6),
    "angle beyond half a turn": lambda c: replace(c, approach_angle_rad=7.0),
    "angle not a number": lambda c: replace(c, approach_angle_rad=float("nan")),
    "branch": lambda c: replace(c, branch=c.branch ^ 1),
    "branch that no arm has": lambda c: replace(c, branch=8),
    "side": lambda c: replace(c, tool_side=-1),
    "standby": lambda c: replace(c, standby_joints=_moved(c.standby_joints, 3, 1e-7)),
    "thinning": lambda c: replace(c, thinning_joints=_moved(c.thinning_joints, 0, 1e-7)),
    "thinning not a number": lambda c: replace(
        c, thinning_joints=_moved(c.thinning_joints, 0, float("nan"))
    ),
    "fewer joints": lambda c: replace(c, thinning_joints=c.thinning_joints[:5]),
    "no such target": lambda c: replace(c, target_id="99"),
    "another target": lambda c: replace(c, target_id="5"),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_what_was_tampered_with_is_refused(plan: Plan, name: MethodName) -> None:
    choices = chosen(plan)
    choices[1] = TAMPERED[name](choices[1])
    with pytest.raises(RetimingFailed) as raised:
        retime(plan.problem, choices)
    assert raised.value.target_id == choices[1].target_id
    assert raised.value.detail


def test_what_does_not_hold_for_the_problem_any_more_is_refused(plan: Plan) -> None:
    margin = min(approach.margin_rad or 0.0 for approach in plan.approaches)
    stricter = replace(plan.problem.options, limit_margin_rad=margin + 1e-6)
    with pytest.raises(RetimingFailed, match="limit_excess_rad"):
        retime(replace(plan.problem, options=stricter), chosen(plan))


def test_failure_passes_between_processes() -> None:
    failure = pickle.loads(pickle.dumps(RetimingFailed("7", "is gone")))
    assert (failure.target_id, failure.detail, str(failure)) == ("7", "is gone", "7: is gone")
