"""What restoration does in one step and where it begins, by plain formulas."""

import numpy as np
import pytest

from solver.approach.task.feasibility import CutInTask
from solver.approach.task.relaxation import Placement
from solver.approach.task.task import ApproachTask
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.methods.nlp.whole_cut_in import pose_of
from solver.methods.relaxed import restoration
from solver.methods.relaxed.restoration import (
    KINDS,
    bring_into_zone,
    least_room,
    relaxed_posture,
    restore,
    restored_points,
    room,
)
from solver.methods.relaxed.tolerances import RESTORED_ANGLES
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

ZONE = np.array([0.03, 0.3])
INSIDE = np.array([0.2, 0.4, 0.3, -0.5])


def placed(task: ApproachTask, x: np.ndarray) -> Placement:
    swing = ZONE[1] * (x[2] * task.frame.outward + x[3] * task.frame.sideways)
    return Placement(float(x[0]), float(ZONE[0] * x[1]), swing)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("x", [INSIDE, np.array([-0.4, 0.0, 0.0, 0.0])])
@pytest.mark.parametrize("retreat", [0.0, 0.04])
def test_a_relaxed_posture_stands_where_its_numbers_say(
    side: int, x: np.ndarray, retreat: float
) -> None:
    """As the inverse of the pose itself says, made with rotations as matrices."""
    task = small_task(symmetric_tool=True)
    pose = pose_of(task, side, placed(task, x))
    pose[:3, 3] -= retreat * pose[:3, 2]
    expected = inverse_kinematics(task.robot, task.tool, pose[None])
    q = np.empty(6)
    for branch in range(8):
        reach = relaxed_posture(task.for_kernels(side), ZONE, x, retreat, branch, q)
        assert (reach >= 0.0) == expected.reachable[0, branch]
        if reach >= 0.0:
            turned = np.remainder(q - expected.joints[0, branch] + np.pi, 2 * np.pi) - np.pi
            assert turned == pytest.approx(np.zeros(6), abs=1e-9)


def test_room_is_told_of_each_limit_and_of_the_reach() -> None:
    task = small_task().for_kernels(1)
    q = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    rooms = [room(task, 0.05, q, kind) for kind in range(KINDS)]
    assert rooms[:12:2] == pytest.approx(q - task.lower)
    assert rooms[1:12:2] == pytest.approx(task.upper - q)
    assert rooms[12:] == [pytest.approx(0.05 / task.geometry.a2)]


def test_the_least_room_of_each_kind_is_over_all_rows() -> None:
    task, branch = small_task().for_kernels(1), 2
    values, rows = np.empty(KINDS), np.full(KINDS, -1)
    least = least_room(task, ZONE, INSIDE, branch, task.retreats, values, rows)
    every = np.empty((len(task.retreats), KINDS))
    for n, retreat in enumerate(task.retreats):
        q = np.empty(6)
        reach = relaxed_posture(task, ZONE, INSIDE, retreat, branch, q)
        every[n] = [room(task, reach, q, kind) for kind in range(KINDS)]
    np.testing.assert_array_equal(values, every.min(axis=0))
    np.testing.assert_array_equal(rows, every.argmin(axis=0))
    assert least == every.min()
    assert len(set(rows.tolist())) > 1


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        ((5.0, 0.3, 0.3, -0.4), (5.0, 0.3, 0.3, -0.4)),
        ((-5.0, -0.3, 0.6, -0.8), (-5.0, 0.0, 0.6, -0.8)),
        ((0.0, 1.3, 3.0, -4.0), (0.0, 1.0, 0.6, -0.8)),
    ],
)
def test_strike_and_swing_are_brought_back(
    x: tuple[float, ...], expected: tuple[float, ...]
) -> None:
    brought = np.array(x)
    bring_into_zone(brought)
    assert brought == pytest.approx(expected)


def rooms_at(task: CutInTask, x: np.ndarray, branch: int) -> tuple[np.ndarray, np.ndarray]:
    values, rows = np.empty(KINDS), np.zeros(KINDS, dtype=np.int64)
    least_room(task, ZONE, x, branch, task.retreats, values, rows)
    return values, rows


def plain_step(task: CutInTask, x: np.ndarray, branch: int, free: list[int]) -> np.ndarray:
    """The damped shortest step, in some of the numbers, that brings 1e-4 inside what is not."""
    values, rows = rooms_at(task, x, branch)
    broken = np.flatnonzero(values < 1e-4)
    slopes = np.zeros((len(broken), 4))
    for j in free:
        for k, kind in enumerate(broken):
            ends = []
            for change in (-1e-5, 1e-5):
                beside, q = x.copy(), np.empty(6)
                beside[j] += change
                reach = relaxed_posture(task, ZONE, beside, task.retreats[rows[kind]], branch, q)
                ends.append(room(task, reach, q, kind))
            slopes[k, j] = (ends[1] - ends[0]) / 2e-5
    damped = np.vstack((slopes, np.sqrt(1e-4) * np.eye(4)))
    wanted = np.concatenate((1e-4 - values[broken], np.zeros(4)))
    return np.asarray(np.linalg.lstsq(damped, wanted, rcond=None)[0])


def broken_starts(strike: float, far: float = 0.3) -> list[tuple[CutInTask, int, np.ndarray]]:
    """Some that are outside limits or reach, by up to so much."""
    found = []
    for index in (0, 2, 4):
        task = small_task(index).for_kernels(1)
        for branch in range(8):
            for angle in np.linspace(-3.0, 3.0, 16):
                x = np.array([angle, strike, 0.1, -0.2])
                values, _ = rooms_at(task, x, branch)
                if -far < values.min() < -0.05:
                    found.append((task, branch, x))
    return found[:: max(1, len(found) // 10)]


@pytest.mark.parametrize("strike", [0.0, 0.5, 1.0])
def test_one_step_is_the_shortest_that_repairs(
    monkeypatch: pytest.MonkeyPatch, strike: float
) -> None:
    """None is longer than 0.4; what presses against an end of the strike zone stays there."""
    monkeypatch.setattr(restoration, "RESTORED_ROUNDS", 1)
    pressed = long = 0
    starts = broken_starts(strike, 0.3 if strike < 1.0 else 1.0)
    assert len(starts) >= 8
    for task, branch, x in starts:
        step = plain_step(task, x, branch, [0, 1, 2, 3])
        if (strike == 0.0 and step[1] < 0.0) or (strike == 1.0 and step[1] > 0.0):
            step = plain_step(task, x, branch, [0, 2, 3])
            assert step[1] == pytest.approx(0.0, abs=1e-12)
            pressed += 1
        long += np.abs(step).max() > 0.4
        expected = x + step * min(1.0, 0.4 / np.abs(step).max())
        bring_into_zone(expected)
        after = x.copy()
        assert not interpreted(restore)(task, ZONE, branch, after)
        assert after == pytest.approx(expected, abs=1e-4)
    assert pressed > 0 or strike == 0.5
    assert long > 0 or strike != 0.5


def test_restored_is_what_holds_and_nothing_else() -> None:
    restored = failed = 0
    for task, branch, start in broken_starts(0.5):
        x = start.copy()
        holds = restore(task, ZONE, branch, x)
        least = rooms_at(task, x, branch)[0].min()
        assert holds == (least >= 0.0)
        restored += holds
        failed += not holds
        assert 0.0 <= x[1] <= 1.0
        assert np.hypot(x[2], x[3]) <= 1.0 + 1e-12
    assert restored >= 3


def test_a_zone_that_helps_nothing_is_given_up_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no number changes any room, steps are none."""
    looks = []

    def never(*arguments: object) -> float:
        looks.append(1)
        values = arguments[5]
        assert isinstance(values, np.ndarray)
        values[:] = -1.0
        return -1.0

    monkeypatch.setattr(restoration, "least_room", never)
    monkeypatch.setattr(restoration, "room", lambda *_: -1.0)
    x = np.array([0.1, 0.5, 0.0, 0.0])
    assert not interpreted(restore)(small_task().for_kernels(1), ZONE, 2, x)
    assert len(looks) == 1
    assert x.tolist() == [0.1, 0.5, 0.0, 0.0]


def waves(k: int, strike: float, branch: int) -> float:
    """Of an angle's number: peaks at 5, 20 and 47 on two branches, at 0 on another, far outside."""
    if branch in (1, 6):
        heights = {5: -0.2, 20: -0.5, 47: -0.1}
        away = {at: min(abs(k - at), RESTORED_ANGLES - abs(k - at)) for at in heights}
        lift = 0.03 * (branch == 6) + 0.011 * strike
        return max(heights[at] - 0.07 * away[at] for at in heights) + lift
    return (-1.2 if branch == 3 else -1.6) - 0.01 * min(k, RESTORED_ANGLES - k)


@pytest.mark.parametrize("strike_m", [0.0, 0.03])
def test_restoration_begins_at_the_angles_that_come_closest(
    monkeypatch: pytest.MonkeyPatch, strike_m: float
) -> None:
    """The twelve closest, both ends of the strike zone, none further than 1.5 outside."""
    tried: list[tuple[int, int, float]] = []
    step = 2 * np.pi / RESTORED_ANGLES
    task = small_task().for_kernels(1)

    def stand_in(_: object, zone: object, x: np.ndarray, branch: int, ends: np.ndarray,
                 *rest: object) -> float:  # fmt: skip
        assert ends.tolist() == [0.0, task.retreats[0]]
        assert x[2:].tolist() == [0.0, 0.0]
        return waves(round(x[0] / step), float(x[1]), branch)

    def restore_some(_: object, zone: object, branch: int, x: np.ndarray) -> bool:
        assert x[0] == pytest.approx(step * round(x[0] / step))
        assert x[2:].tolist() == [0.0, 0.0]
        tried.append((branch, round(x[0] / step), float(x[1])))
        x[:] = 9.0, 0.5, 0.25, -0.125
        return len(tried) % 2 == 1

    monkeypatch.setattr(restoration, "least_room", stand_in)
    monkeypatch.setattr(restoration, "restore", restore_some)
    zone = np.array([strike_m, 0.4])
    points = interpreted(restored_points)(task, zone)
    shares = (0.0, 1.0) if strike_m else (0.0,)
    peaks = [
        (branch, k, share)
        for share in shares
        for branch, own in ((1, (5, 20, 47)), (3, (0,)), (6, (5, 20, 47)))
        for k in own
    ]
    peaks.sort(key=lambda peak: -waves(peak[1], peak[2], peak[0]))
    assert tried == peaks[:12]
    assert len(peaks) == (14 if strike_m else 7)
    assert len(points) == (len(tried) + 1) // 2
    assert points.tolist() == [pytest.approx([strike_m / 2, 0.1, -0.05])] * len(points)
