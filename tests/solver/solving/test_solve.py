from dataclasses import replace

import numpy as np
import pytest

from bench.order_references import greedy_effort
from solver import Options, Plan, Problem, Robot, Target, solve, verify_plan
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task
from solver.methods.semi_analytic import solve_ssas
from solver.problem.options import MethodName, Norm
from tests.solver.problems import DATA_SET_3, data_set_3, random_targets


def comparable(plan: Plan) -> list[object]:
    """A plan without what the clock says."""
    rows: list[object] = []
    for a in plan.approaches:
        trajectory = a.trajectory.joints.tolist() if a.trajectory else None
        path = np.asarray(a.path_joints).tolist() if a.path_joints is not None else None
        rows.append((a.target_id, a.status, a.reason, a.effort, a.branch, path, trajectory))
    return rows


@pytest.mark.parametrize("method", ["floating_z", "ssas", "ncos"])
def test_data_set_3_is_planned_whole(tabletop: Robot, method: MethodName) -> None:
    plan = solve(data_set_3(tabletop, method=method))
    assert (plan.planned, plan.infeasible) == (5, 0)
    assert [approach.target_id for approach in plan.approaches] == ["1", "2", "3", "4", "5"]


def test_the_same_request_has_the_same_answer(tabletop: Robot) -> None:
    problem = Problem(tabletop, random_targets(seed=41, count=15))
    assert comparable(solve(problem)) == comparable(solve(problem))


def test_independent_does_not_depend_on_the_order_of_targets(tabletop: Robot) -> None:
    targets = random_targets(seed=42, count=15)
    options = Options(order="independent", method="ssas")
    forward = comparable(solve(Problem(tabletop, targets, options=options)))
    backward = comparable(solve(Problem(tabletop, targets[::-1], options=options)))
    assert forward == backward[::-1]


def test_unreachable_targets_keep_their_place_and_do_not_move_the_reference(
    tabletop: Robot,
) -> None:
    far = Target("far", (0.0, 2.0, 0.1), (0, 0, 1))
    mixed = solve(Problem(tabletop, [DATA_SET_3[0], far, *DATA_SET_3[1:]]))
    alone = solve(Problem(tabletop, DATA_SET_3))
    assert [a.status for a in mixed.approaches] == ["planned", "infeasible", *["planned"] * 4]
    reason = mixed.approaches[1].reason
    assert reason is not None
    assert reason.code == "out_of_reach"
    assert reason.margin_m is not None
    assert reason.margin_m < -1.0
    without = [row for row in comparable(mixed) if row[0] != "far"]  # type: ignore[index]
    assert without == comparable(alone)


@pytest.mark.parametrize(
    ("target", "code"),
    [
        (Target("t", (0.9, 0.0, 0.3), (0, 1, 0)), "out_of_reach"),
        (Target("t", (0.05, 0.0, 0.1), (0, 1, 0)), "joint_limit"),
    ],
)
def test_reasons_name_what_limits(tabletop: Robot, target: Target, code: str) -> None:
    approach = solve(Problem(tabletop, [target])).approaches[0]
    assert approach.reason is not None
    assert approach.reason.code == code
    if code == "joint_limit":
        assert approach.reason.joint in tabletop.joint_names
        assert approach.reason.margin_rad is not None
        assert approach.reason.margin_rad < 0


def test_every_reason_code_of_the_first_set_occurs(tabletop: Robot) -> None:
    plan = solve(
        Problem(tabletop, random_targets(seed=43, count=500), options=Options(method="ssas"))
    )
    codes = {approach.reason.code for approach in plan.approaches if approach.reason}
    assert codes >= {"out_of_reach", "joint_limit", "standby_infeasible"}
    assert "solver_failed" not in codes


def test_limits_hold_between_rows_too(tabletop: Robot) -> None:
    """With both ends alone as rows some cut-ins break a limit in the middle; answers never do."""
    options = Options(method="ssas", order="independent", path_points=2, position_margin_m=0.0)
    problem = Problem(tabletop, random_targets(seed=44, count=300), options=options)
    broken = 0
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        candidate = solve_ssas(task)
        if not isinstance(candidate, Candidate) or broken_between(task, candidate) is None:
            continue
        broken += 1
        single = replace(problem, targets=(target,))
        approach = solve(single).approaches[0]
        if approach.status == "planned":
            assert approach.margin_rad is not None
            assert approach.margin_rad >= options.limit_margin_rad - 1e-9
        else:
            assert approach.reason is not None
            assert approach.reason.code != "solver_failed"
    assert broken > 0


def test_joint_weights_change_what_is_cheap(tabletop: Robot) -> None:
    waist = solve(data_set_3(tabletop, method="ssas", joint_weights=(100, 1, 1, 1, 1, 1)))
    even = solve(data_set_3(tabletop, method="ssas"))
    start = np.array(tabletop.home_joints)
    travel = [abs(np.asarray(p.approaches[0].thinning_joints) - start)[0] for p in (waist, even)]
    assert travel[0] < travel[1]


def test_straightness_asked_for_is_kept(tabletop: Robot) -> None:
    plan = solve(data_set_3(tabletop, method="ssas", straightness_m=1e-6))
    assert plan.planned == 5
    deviations = [approach.path_deviation_m for approach in plan.approaches]
    assert all(deviation is not None and deviation <= 1e-6 for deviation in deviations)


@pytest.mark.parametrize("method", ["floating_z", "ssas", "ncos"])
def test_a_chosen_order_has_the_infeasible_last(tabletop: Robot, method: MethodName) -> None:
    far = Target("far", (0.0, 2.0, 0.1), (0, 0, 1))
    options = Options(method=method, order="optimal")
    plan = solve(Problem(tabletop, [far, *DATA_SET_3], options=options))
    assert [a.status for a in plan.approaches] == [*["planned"] * 5, "infeasible"]
    assert plan.approaches[-1].target_id == "far"
    assert {a.target_id for a in plan.approaches} == {"far", "1", "2", "3", "4", "5"}
    verified = verify_plan(plan)
    assert len(verified) == 5
    assert all(entry.accepted for entry in verified.values())


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_batches_planned_as_one_verify_and_are_cheaper_than_greedy(
    tabletop: Robot, norm: Norm
) -> None:
    problem = Problem(
        tabletop, random_targets(seed=45, count=40), options=Options(method="ssas", norm=norm)
    )
    plan = solve(problem)
    assert plan.planned >= 10
    assert all(entry.accepted for entry in verify_plan(plan).values())
    assert [a.target_id for a in plan.approaches] == [t.id for t in problem.targets]
    assert plan.total_effort < greedy_effort(problem)


@pytest.mark.parametrize("value", [5e-324, 1e-300, 1e-160, 1e-20])
@pytest.mark.parametrize("name", ["dwell_s", "limit_margin_rad", "joint_weights"])
@pytest.mark.parametrize("order", ["independent", "given", "optimal"])
def test_numbers_that_underflow_are_answered(
    tabletop: Robot, order: str, name: str, value: float
) -> None:
    """A dwell of 1e-20 s had no place behind the seconds before it, and ended every target."""
    given: object = [value] * 6 if name == "joint_weights" else value
    for norm in ("l1", "l2"):
        plan = solve(data_set_3(tabletop, method="ssas", order=order, norm=norm, **{name: given}))
        assert plan.planned == 5
