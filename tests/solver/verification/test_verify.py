"""Every planned answer passes; an answer spoiled anywhere does not."""

import ast
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from solver import (
    Approach,
    Options,
    Plan,
    Problem,
    Robot,
    Segment,
    load_robot,
    solve,
    verify,
    verify_plan,
)
from solver.approach.task.frame import approach_frame
from solver.approach.tolerances import UNCERTAINTY_DEVIATIONS
from solver.approach.uncertainty.robustness import path_displacement_margin
from solver.methods.registry import METHODS
from solver.problem.options import MethodName, Order
from solver.verification.verify import judge
from tests.solver.problems import DATA_SET_3, data_set_3, random_targets, targets_for


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("order", ["independent", "given"])
def test_every_planned_answer_verifies(tabletop: Robot, method: MethodName, order: Order) -> None:
    targets = targets_for(method, seed=31, count=40)
    plan = solve(Problem(tabletop, targets, options=Options(method=method, order=order)))
    results = verify_plan(plan)
    assert len(results) == plan.planned >= 10
    for target_id, verification in results.items():
        assert verification.accepted, (target_id, verification.failures)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return solve(data_set_3(load_robot("tabletop"), method="ssas", position_margin_m=0.0))


def _nudged(field: str, index: tuple[int, ...], amount: float) -> Callable[[Approach], Approach]:
    def spoil(approach: Approach) -> Approach:
        value = np.array(getattr(approach, field))
        value[index] += amount
        changes: dict[str, Any] = {field: value if value.ndim else float(value)}
        return replace(approach, **changes)

    return spoil


def _times(field: str, factor: float) -> Callable[[Approach], Approach]:
    return lambda approach: replace(approach, **{field: factor * getattr(approach, field)})


def _faster(approach: Approach) -> Approach:
    assert approach.trajectory is not None
    segments = tuple(
        Segment(s.name, s.start_s * 0.9, s.end_s * 0.9) for s in approach.trajectory.segments
    )
    times = approach.trajectory.times_s * 0.9
    return replace(
        approach, trajectory=replace(approach.trajectory, times_s=times, segments=segments)
    )


SPOILERS: dict[str, Callable[[Approach], Approach]] = {
    "branch": lambda a: replace(a, branch=(a.branch or 0) ^ 1),
    "a path row": _nudged("path_joints", (7, 2), 1e-5),
    "not a number": _nudged("path_joints", (7, 2), np.nan),
    "fewer rows": lambda a: replace(a, path_joints=np.asarray(a.path_joints)[::2]),
    "effort not a number": _nudged("effort", (), np.nan),
    "displacement margin threefold": _times("displacement_margin_m", 3.0),
    "too fast": _faster,
    "nothing": lambda a: Approach(a.target_id, a.status, a.solver),
    "another target": lambda a: replace(a, target_id="5"),
    "unknown target": lambda a: replace(a, target_id="99"),
}
"""What breaks several residuals at once; `test_verify_residuals` has one for each."""


@pytest.mark.parametrize("spoil", SPOILERS.values(), ids=SPOILERS.keys())
def test_spoiled_answers_do_not_verify(plan: Plan, spoil: Callable[[Approach], Approach]) -> None:
    honest = plan.approaches[0]
    assert verify(plan.problem, honest, plan.problem.start).accepted
    spoiled = spoil(honest)
    verification = verify(plan.problem, spoiled, plan.problem.start)
    assert not verification.accepted
    assert verification.failures
    judged = judge(plan.problem, spoiled, plan.problem.start)
    assert judged.status == "infeasible"
    assert judged.reason is not None
    assert judged.reason.code == "solver_failed"
    assert verification.failures[0].name in judged.reason.detail


def test_another_reference_does_not_verify(plan: Plan) -> None:
    assert not verify(plan.problem, plan.approaches[1], plan.problem.start).accepted


def test_limits_count_with_the_margin_asked_for(plan: Plan) -> None:
    approach = plan.approaches[0]
    assert approach.margin_rad is not None
    assert approach.branch is not None
    assert approach.path_joints is not None
    for change, failures in ((-1e-6, []), (1e-6, ["limit_excess_rad"])):
        options = replace(plan.problem.options, limit_margin_rad=approach.margin_rad + change)
        strict = replace(plan.problem, options=options)
        # A target's freedom to move ends at the limits less the margin, so it is claimed anew.
        freedom = path_displacement_margin(
            strict.robot, strict.mounted_tool, options, approach.branch, approach.path_joints[-1]
        )
        assert approach.displacement_margin_m is not None
        assert 0.0 <= freedom < approach.displacement_margin_m
        claim = replace(approach, displacement_margin_m=freedom)
        verification = verify(strict, claim, plan.problem.start)
        assert [residual.name for residual in verification.failures] == failures
        stale = [r.name for r in verify(strict, approach, plan.problem.start).failures]
        assert stale == (failures or ["displacement_margin_claim_m"])


def test_a_target_more_uncertain_than_its_posture_bears_does_not_verify(plan: Plan) -> None:
    approach = plan.approaches[0]
    assert approach.displacement_margin_m is not None
    borne = approach.displacement_margin_m / UNCERTAINTY_DEVIATIONS
    for std, accepted in ((0.999 * borne, True), (1.001 * borne, False)):
        first = replace(plan.problem.targets[0], position_std_m=std)
        problem = replace(plan.problem, targets=(first, *plan.problem.targets[1:]))
        verification = verify(problem, approach, plan.problem.start)
        assert verification.accepted is accepted
        names = [residual.name for residual in verification.failures]
        assert names == ([] if accepted else ["uncertainty_excess_m"])


def _mentions_planned(node: ast.AST) -> bool:
    match node:
        case ast.Name(id="PLANNED", ctx=ast.Load()) | ast.Attribute(attr="PLANNED"):
            return True
        case ast.Constant(value="planned"):
            return True
    return False


def test_only_the_verifier_gives_the_status_planned() -> None:
    """Others compare with it, and nothing else: neither as an argument nor under another name."""
    folder, users = Path(solver.__file__).parent, set()
    for file in folder.rglob("*.py"):
        tree = ast.parse(file.read_text())
        compared = {
            part
            for node in ast.walk(tree)
            if isinstance(node, ast.Compare)
            for part in ast.walk(node)
        }
        # The key of a count is no status of anything.
        keys = {k for node in ast.walk(tree) if isinstance(node, ast.Dict) for k in node.keys}
        others = set(ast.walk(tree)) - compared - keys
        if any(map(_mentions_planned, others)):
            users.add(str(file.relative_to(folder)))
    assert users == {
        "verification/verify.py",
        "verification/many.py",
        # What gives it its name.
        "problem/solution.py",
        # As the account of a method, of which the verifier then judges the approach.
        "solving/retiming.py",
        # Accounts of a comparison, which follow a verifier.
        "comparison/approach_contest.py",
        "comparison/scenarios/strawberry.py",
    }


RELAXED: dict[str, Any] = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.15}


@pytest.fixture(scope="module")
def relaxed() -> Plan:
    options = Options(order="independent", **RELAXED)
    return solve(
        Problem(load_robot("tabletop"), random_targets(seed=33, count=16), options=options)
    )


@pytest.mark.parametrize("method", METHODS)
def test_relaxed_plans_verify_by_every_method(tabletop: Robot, method: MethodName) -> None:
    """Those without relaxations solve the unrelaxed task, and say that they use nothing."""
    problem = data_set_3(tabletop, method=method, **RELAXED)
    if method == "fixed_z":
        problem = replace(problem, targets=targets_for(method, seed=31, count=20))
    plan = solve(problem)
    results = verify_plan(plan)
    assert len(results) == plan.planned > 0
    for approach in plan.approaches:
        if approach.status != "planned":
            continue
        assert results[approach.target_id].accepted
        assert approach.strike_m is not None
        assert approach.tilt_rad is not None
        if method != "ncos":
            assert abs(approach.strike_m) < 1e-9
            assert approach.tilt_rad < 1e-9


def test_relaxed_answers_use_the_relaxations_and_only_what_is_on_is_told(
    relaxed: Plan, plan: Plan
) -> None:
    assert relaxed.planned >= 3
    used = [(a.strike_m or 0.0, a.tilt_rad or 0.0) for a in relaxed.approaches]
    assert max(strike for strike, _ in used) > 1e-3
    assert max(tilt for _, tilt in used) > 1e-2
    assert all(a.strike_m is None and a.tilt_rad is None for a in plan.approaches)


@pytest.mark.parametrize(
    ("spoil", "residual"),
    [
        (_nudged("strike_m", (), 2e-6), "strike_claim_m"),
        (_nudged("strike_m", (), np.nan), "strike_claim_m"),
        (_nudged("tilt_rad", (), -2e-6), "tilt_claim_rad"),
        (lambda a: replace(a, strike_m=None), "strike_claim_m"),
        (lambda a: replace(a, tilt_rad=None), "tilt_claim_rad"),
        (_nudged("approach_angle_rad", (), 1e-5), "path_axes_rad"),
        (_nudged("path_joints", (7, 2), 1e-5), "path_position_m"),
        (_nudged("path_joints", (7, 5), 1e-5), "path_axes_rad"),
    ],
)
def test_spoiled_relaxed_answers_do_not_verify(
    relaxed: Plan, spoil: Callable[[Approach], Approach], residual: str
) -> None:
    approach = next(a for a in relaxed.approaches if a.status == "planned")
    assert verify(relaxed.problem, approach, relaxed.problem.start).accepted
    verification = verify(relaxed.problem, spoil(approach), relaxed.problem.start)
    assert residual in [failure.name for failure in verification.failures]


@pytest.mark.parametrize(
    ("options", "residual"),
    [
        ({"strike_zone_m": 0.0}, "path_position_m"),
        ({"tilt_tolerance_rad": 0.0}, "path_axes_rad"),
        ({"strike_zone_m": "a little less"}, "path_position_m"),
        ({"tilt_tolerance_rad": "a little less"}, "path_axes_rad"),
    ],
)
def test_more_than_is_allowed_does_not_verify(
    relaxed: Plan, options: dict[str, Any], residual: str
) -> None:
    """An answer that used its relaxations is none where there are less of them."""
    used = {
        "strike_zone_m": lambda a: (a.strike_m or 0.0) - 1e-5,
        "tilt_tolerance_rad": lambda a: (a.tilt_rad or 0.0) - 1e-5,
    }
    checked = 0
    start = relaxed.problem.start
    for approach in relaxed.approaches:
        (name, value), *_ = options.items()
        less = used[name](approach) if value == "a little less" else value
        if approach.status == "planned" and used[name](approach) > 1e-4:
            change: dict[str, Any] = {name: less}
            strict = replace(relaxed.problem.options, **change)
            problem = replace(relaxed.problem, options=strict)
            assert verify(relaxed.problem, approach, start).accepted
            failures = verify(problem, approach, start).failures
            assert residual in [failure.name for failure in failures]
            checked += 1
    assert checked


def test_claims_without_the_option_do_not_verify(plan: Plan) -> None:
    for field in ("strike_m", "tilt_rad"):
        claim: dict[str, Any] = {field: 0.0}
        spoiled = replace(plan.approaches[0], **claim)
        assert not verify(plan.problem, spoiled, plan.problem.start).accepted


def test_both_sides_of_a_symmetric_tool_are_planned(tabletop: Robot) -> None:
    options = Options(method="ssas", order="independent", symmetric_tool=True)
    plan = solve(Problem(tabletop, random_targets(55, 40), options))
    done = [one for one in plan.approaches if one.status == "planned"]
    assert {one.tool_side for one in done} == {1, -1}
    for one in done:
        assert verify(plan.problem, one, plan.problem.start).accepted


def test_no_margin_at_all_is_a_level(tabletop: Robot) -> None:
    """Told of a target that no approach lets move even by an eighth of what is wished for."""
    options = Options(method="ssas", order="independent", position_margin_m=0.05)
    plan = solve(Problem(tabletop, random_targets(55, 40), options))
    bare = [one for one in plan.approaches if one.position_margin_m == 0.0]
    assert bare
    for one in bare:
        assert one.margin_short is True
        assert verify(plan.problem, one, plan.problem.start).accepted
        for level in (1.0, -1.0):
            other = replace(one, position_margin_m=level)
            names = {row.name for row in verify(plan.problem, other, plan.problem.start).failures}
            assert "position_margin_is_level" in names


@pytest.mark.parametrize(("along_m", "accepted"), [(-0.004, True), (0.005, False), (0.025, False)])
def test_the_strike_zone_is_between_the_forks_and_not_before_them(
    tabletop: Robot, along_m: float, accepted: bool
) -> None:
    """The target moved along the approach: between the forks, or ahead of what they reach."""
    options = Options(order="independent", strike_zone_m=0.02)
    target = DATA_SET_3[0]
    (found,) = solve(Problem(tabletop, [target], options)).approaches
    frame = approach_frame(target.position_m, target.branch_direction)
    ahead = frame.direction(found.approach_angle_rad or 0.0)
    place = np.asarray(target.position_m) + (along_m + (found.strike_m or 0.0)) * ahead
    # Straight on along the approach direction, which is normal to the branch: the angle is counted
    # from another direction there.
    moved = replace(target, position_m=tuple(place.tolist()))
    turned = approach_frame(moved.position_m, moved.branch_direction)
    angle = math.atan2(ahead @ turned.sideways, ahead @ turned.outward)
    claim = replace(found, approach_angle_rad=angle, strike_m=-along_m)
    problem = Problem(tabletop, [moved], options)
    names = {row.name for row in verify(problem, claim, problem.start).failures}
    assert names == (set() if accepted else {"path_position_m"})
