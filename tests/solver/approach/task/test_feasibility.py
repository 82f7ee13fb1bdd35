"""One approach with its cut-in, row by row as the inverse of each pose says."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Target, load_robot
from solver.approach.task import feasibility
from solver.approach.task.constraints import JUMP, LIMITS, Constraint
from solver.approach.task.feasibility import (
    choose_packed_turns,
    choose_turns,
    effort,
    evaluate,
    fastest_joint,
    limit_margin,
    nearest_turns,
    posture,
    retreat_from,
    retreat_from_many,
    retreat_reach,
    sample,
    thinning,
    tool_axes,
    trace,
)
from solver.approach.task.packed import LOWER, NEVER_LIMITS, NO_ROOM, REFERENCE, UPPER, jump_cosines
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.spherical_wrist import inverse_kinematics, wrist_geometry
from solver.kinematics.straight_rates import (
    between_rate_room,
    posture_rate_room,
    posture_rates,
)
from solver.robots.rigid import inverse
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.interpreted import interpret, interpreted
from tests.solver.methods.synthetic import small_task

SMALL = small_task(2, symmetric_tool=True, joint_weights=(1, 2, 3, 4, 5, 6))
PUMA = load_robot("puma560")


def puma_task(turned: float = 0.0) -> ApproachTask:
    target = Target("1", (0.4, 0.3, 0.5), (0.2, 1.0, 0.3))
    reference = np.asarray(PUMA.home_joints) + np.array([0, 0, 0, turned, 0, -turned])
    problem = Problem(PUMA, [target], options=Options())
    return approach_task(problem, target, tuple(reference))


def pose_of(task: ApproachTask, side: int, angle: float, retreat: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = task.frame.axes(angle, side)
    pose[:3, 3] = np.asarray(task.target.position_m) - retreat * pose[:3, 2]
    return pose


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("angle", [-0.7, 0.2])
def test_axes_and_postures_are_those_of_the_inverse(side: int, angle: float) -> None:
    kernels, axes, q = SMALL.for_kernels(side), np.empty((3, 3)), np.empty(6)
    tool_axes(kernels, angle, axes)
    turn = SMALL.robot.mount[:3, :3]
    assert turn @ axes == pytest.approx(SMALL.frame.axes(angle, side))
    for retreat in (0.0, 0.03):
        pose = pose_of(SMALL, side, angle, retreat)
        found = inverse_kinematics(SMALL.robot, SMALL.tool, pose[None])
        for branch in range(8):
            reach = posture(kernels, axes, retreat, branch, q)
            assert reach == pytest.approx(found.reach_margin_m[0, branch // 2], abs=1e-12)
            apart = np.remainder(q - found.joints[0, branch] + np.pi, 2 * np.pi) - np.pi
            assert apart == pytest.approx(np.zeros(6), abs=1e-9)


def test_the_joint_nearest_to_its_limit() -> None:
    kernels = SMALL.for_kernels(1)
    middle = (kernels.lower + kernels.upper) / 2
    for joint in range(6):
        q = middle.copy()
        q[joint] = kernels.upper[joint] - 0.01
        assert limit_margin(kernels, q) == (pytest.approx(0.01), joint)
        q[joint] = kernels.lower[joint] - 0.02
        assert limit_margin(kernels, q) == (pytest.approx(-0.02), joint)


def test_joints_are_brought_to_the_turn_nearest_to_the_reference() -> None:
    lower, upper = np.full(6, -7.0), np.full(6, 7.0)
    lower[2], upper[3] = -2.0, 3.0
    task = SMALL.for_kernels(1)._replace(
        lower=lower, upper=upper, reference=np.array([4.0, -4.0, -4.0, 4.0, 0.0, 0.0])
    )
    q = np.array([-1.0, 1.0, 1.0, -1.0, 3.0, -4.0])
    nearest_turns(task, q)
    turn = 2 * math.pi
    assert q == pytest.approx([turn - 1, 1 - turn, 1.0, -1.0, 3.0, turn - 4])


@pytest.mark.parametrize("angle", [0.1, 0.2])
def test_a_trace_is_continuous_and_its_margin_the_least_of_all(angle: float) -> None:
    task, geometry = SMALL.for_kernels(1), wrist_geometry(SMALL.robot, SMALL.tool)
    retreats = np.asarray(SMALL.retreats_m)
    for branch in range(8):
        rows = np.full((len(retreats), 6), np.nan)
        margin = trace(task, angle, branch, retreats, rows)
        axes, q, least = np.empty((3, 3)), np.empty(6), math.inf
        tool_axes(task, angle, axes)
        for n, retreat in enumerate(retreats):
            least = min(least, posture(task, axes, retreat, branch, q))
            apart = np.remainder(rows[n] - q + np.pi, 2 * np.pi) - np.pi
            assert apart == pytest.approx(np.zeros(6), abs=1e-9)
            least = min(least, posture_rate_room(geometry, rows[n]), limit_margin(task, rows[n])[0])
            if n:
                assert np.abs(rows[n] - rows[n - 1]).max() <= np.pi
                step = retreats[n - 1] - retreat
                least = min(least, between_rate_room(geometry, rows[n - 1], rows[n], step))
        assert margin == pytest.approx(least)


@pytest.mark.parametrize("part", ["reach", "rate", "limit"])
def test_each_part_may_be_the_least(part: str) -> None:
    """Of several approaches there are some that fail at it first."""
    task, geometry = SMALL.for_kernels(1), wrist_geometry(SMALL.robot, SMALL.tool)
    retreats, seen = np.asarray(SMALL.retreats_m), set()
    for branch in range(8):
        for angle in np.linspace(-3, 3, 24):
            rows, q = np.empty((len(retreats), 6)), np.empty(6)
            margin = trace(task, angle, branch, retreats, rows)
            axes = np.empty((3, 3))
            tool_axes(task, angle, axes)
            parts = {
                "reach": min(posture(task, axes, r, branch, q) for r in retreats),
                "rate": min(posture_rate_room(geometry, row) for row in rows),
                "limit": min(limit_margin(task, row)[0] for row in rows),
                "between": min(
                    between_rate_room(geometry, rows[n], rows[n + 1], retreats[n] - retreats[n + 1])
                    for n in range(len(rows) - 1)
                ),
            }
            assert margin == pytest.approx(min(parts.values()))
            seen.add(min(parts, key=lambda name: parts[name]))
    assert part in seen


def test_between_each_two_rows_rates_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[np.ndarray, np.ndarray, float]] = []

    def between(geometry: object, before: np.ndarray, after: np.ndarray, spacing: float) -> float:
        asked.append((before.copy(), after.copy(), spacing))
        return -0.25 if len(asked) == 2 else 0.5

    interpret(monkeypatch, feasibility, between_rate_room=between)
    task, retreats = SMALL.for_kernels(1), np.array([0.03, 0.02, 0.005, 0.0])
    rows = np.empty((4, 6))
    assert interpreted(trace)(task, 0.2, 2, retreats, rows) == -0.25
    assert [one[2] for one in asked] == pytest.approx([0.005, 0.015, 0.01])
    for k, (before, after, _) in enumerate(asked):
        assert before == pytest.approx(rows[2 - k])
        assert after == pytest.approx(rows[3 - k])


def test_the_fastest_joint_of_a_cut_in_and_its_row() -> None:
    task = SMALL.for_kernels(1)
    retreats, rates = np.array([0.03, 0.02, 0.0]), np.empty(6)
    rows = SMALL.postures(0.2, 1, 2, retreats)
    every = []
    for n in range(3):
        posture_rates(task.geometry, rows[n], rates)
        every += [(rates[i], i, n) for i in range(6)]
        if n < 2:
            steps = np.abs(rows[n] - rows[n + 1]) / (retreats[n] - retreats[n + 1])
            every += [(steps[i], i, n) for i in range(6)]
    expected = max(every)
    assert fastest_joint(task.geometry, retreats, rows) == pytest.approx(expected)
    rows[1, 4] += 9.0
    rate, joint, row = fastest_joint(task.geometry, retreats, rows)
    assert (joint, row) == (4, 1 if abs(rows[1, 4] - rows[2, 4]) / 0.02 > rate - 1e-9 else 0)
    assert rate == pytest.approx(max(abs(rows[0, 4] - rows[1, 4]) / 0.01, 0.0), rel=1e-9)


def test_joints_of_more_than_one_turn_are_where_the_whole_cut_in_is_inside() -> None:
    lower, upper = np.full(6, -5.0), np.full(6, 5.0)
    lower[0], upper[0] = -3.0, 3.0
    reference = np.array([4.0, 4.0, -4.0, 0.0, 4.9, 0.0])
    rows = np.array([[-1.0, -1.0, 1.0, -1.0, -1.0, 6.0], [-1.2, -1.2, 1.2, -1.2, -2.0, 6.5]])
    before, turn = rows.copy(), 2 * math.pi
    choose_turns(lower, upper, reference, rows)
    # One turn only; to the reference; back to it; no turn is nearer; one row would be outside; and
    # what is outside is brought inside.
    moved = [0.0, turn, -turn, 0.0, 0.0, -turn]
    moved[1] = turn if before[0, 1] + turn <= 5.0 else 0.0
    moved[2] = -turn if before[0, 2] - turn >= -5.0 and before[1, 2] - turn >= -5.0 else 0.0
    moved[4] = 0.0
    assert rows == pytest.approx(before + moved)
    numbers = SMALL.packed(1).numbers.copy()
    numbers[LOWER : LOWER + 6], numbers[UPPER : UPPER + 6] = lower, upper
    numbers[REFERENCE : REFERENCE + 6] = reference
    packed = before.copy()
    choose_packed_turns(numbers, packed)
    assert packed.tolist() == rows.tolist()


@pytest.mark.parametrize("away", [0.0, 2 * math.pi, -2 * math.pi])
def test_of_turns_that_are_inside_the_nearest_is_chosen(away: float) -> None:
    lower, upper, reference = np.full(6, -9.5), np.full(6, 9.5), np.full(6, 0.4 + away)
    rows = np.tile([[0.2], [0.1]], (1, 6))
    choose_turns(lower, upper, reference, rows)
    assert rows == pytest.approx(np.tile([[0.2], [0.1]], (1, 6)) + away)


@pytest.mark.parametrize("turned", [0.0, 4.0, -4.0])
def test_a_thinning_posture_is_on_the_turn_next_to_the_reference(turned: float) -> None:
    task = puma_task(turned)
    kernels, q = task.for_kernels(1), np.empty(6)
    for branch in range(8):
        margin = thinning(kernels, 0.3, branch, q)
        axes, plain = np.empty((3, 3)), np.empty(6)
        tool_axes(kernels, 0.3, axes)
        reach = posture(kernels, axes, 0.0, branch, plain)
        for i in range(6):
            choices = [plain[i] + 2 * math.pi * k for k in (-1, 0, 1)]
            inside = [one for one in choices if task.lower[i] <= one <= task.upper[i]]
            best = min(inside, key=lambda one: abs(one - task.reference[i]), default=plain[i])
            assert q[i] == pytest.approx(best)
        assert margin == pytest.approx(min(reach, limit_margin(kernels, q)[0]))


def test_rows_straight_behind_a_pose() -> None:
    task = puma_task()
    geometry, retreats = wrist_geometry(PUMA, task.tool), np.array([0.05, 0.02, 0.0])
    paths, expected = np.empty((2, 3, 6)), []
    poses, branches = [], np.array([1, 4])
    for k, branch in enumerate(branches):
        pose = inverse(PUMA.mount) @ pose_of(task, 1, 0.3 + k, 0.0)
        poses.append(pose)
        q = inverse_kinematics(PUMA, task.tool, pose_of(task, 1, 0.3 + k, 0.0)[None]).joints[0]
        # On another turn than the inverse's own, on which the others have to be as well.
        paths[k, -1] = q[branch] + 2 * math.pi * np.array([0, 0, 0, 1, 0, -1])
        expected.append(paths[k, -1].copy())
    retreat_from_many(geometry, np.array(poses), branches, retreats, paths)
    for k, branch in enumerate(branches):
        alone = np.empty((3, 6))
        alone[-1] = expected[k]
        retreat_from(geometry, poses[k], branch, retreats, alone)
        assert paths[k].tolist() == alone.tolist()
        assert alone[-1].tolist() == expected[k].tolist()
        margins = np.empty(3)
        retreat_reach(geometry, poses[k], branch, retreats, margins)
        for n, retreat in enumerate(retreats):
            found = inverse_kinematics(PUMA, task.tool, pose_of(task, 1, 0.3 + k, retreat)[None])
            apart = np.remainder(alone[n] - found.joints[0, branch] + np.pi, 2 * np.pi) - np.pi
            assert apart == pytest.approx(np.zeros(6), abs=1e-7)
            assert np.abs(alone[n] - alone[-1]).max() < 2.0
            assert margins[n] == pytest.approx(found.reach_margin_m[0, branch // 2], abs=1e-12)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_effort_and_evaluation(norm: str) -> None:
    task = small_task(2, norm=norm, joint_weights=(1, 2, 3, 4, 5, 6)).for_kernels(1)
    q = np.linspace(-1.0, 1.0, 6)
    change = np.abs(q - task.reference)
    expected = np.arange(1, 7) @ (change if norm == "l1" else change**2)
    assert effort(task, q) == pytest.approx(expected)
    rows, other = np.empty((len(task.retreats), 6)), np.empty((len(task.retreats), 6))
    angles = np.array([-2.0, 0.2, 0.9])
    margins, efforts = np.empty((8, 3)), np.empty((8, 3))
    sample(task, angles, margins, efforts)
    looked = {True: 0, False: 0}
    for branch in range(8):
        for k, angle in enumerate(angles):
            margin, cost = evaluate(task, angle, branch, rows)
            assert (margins[branch, k], efforts[branch, k]) == (margin, cost)
            alone = thinning(task, angle, branch, other[-1])
            near = alone >= -0.3
            looked[bool(near)] += 1
            if near:
                assert margin == trace(task, angle, branch, task.retreats, other)
            else:
                assert margin == alone
            assert cost == pytest.approx(effort(task, other[-1]))
    assert min(looked.values()) > 0


def test_constraints_are_numbered_after_the_joints() -> None:
    assert (LIMITS, JUMP) == (13, 8)
    assert [int(one) for one in Constraint] == [-1, 6, 7, 8]


def test_cosines_of_jumps_and_one_more_row() -> None:
    retreats = np.array([0.04, 0.039, 0.0389, 0.0])
    cosines = jump_cosines(retreats)
    travel = JOINT_RATE_RAD_M * np.array([0.001, 0.0001, 0.0389])
    expected = np.where(travel < math.pi, np.cos(travel), NEVER_LIMITS)
    assert cosines == pytest.approx(expected)
    assert NEVER_LIMITS < -1.0
    assert NO_ROOM > 1.0
    more = SMALL.with_retreat(0.0123)
    assert more.retreats_m == tuple(sorted((*SMALL.retreats_m, 0.0123), reverse=True))
    assert SMALL.with_retreat(0.0).retreats_m == SMALL.retreats_m
    assert replace(more, retreats_m=SMALL.retreats_m) == SMALL
