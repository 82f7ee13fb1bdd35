"""What is added to a programme from round to round, on stand-ins for its answers."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.task.relaxation import Placement
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.methods.nlp import whole_cut_in
from solver.methods.nlp.instance import Instance, ProgrammeResult, Start
from solver.methods.nlp.starts import start_at
from solver.methods.nlp.whole_cut_in import (
    ProgrammeAnswer,
    _broken_row,
    _exact_posture,
    pose_of,
    solve_whole_cut_in,
    with_row,
)
from tests.solver.methods.synthetic import small_task

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.2}
SEEN = Placement(0.1, 0.0, np.zeros(3))


def start_of(task: ApproachTask, angle: float = 0.1) -> Start:
    return start_at(task, 1, 2, np.asarray(task.thinning_joints(angle, 1, 2)))


def rows_of(task: ApproachTask) -> np.ndarray:
    return task.postures(0.1, 1, 2, np.asarray(task.retreats_m))


@pytest.mark.parametrize("side", [1, -1])
def test_a_pose_stands_beyond_the_target_and_leans(side: int) -> None:
    task = small_task(symmetric_tool=True)
    lean = 0.2 * task.frame.outward
    pose = pose_of(task, side, Placement(0.7, 0.01, lean))
    assert pose[3].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert pose[:3, 1] @ (side * task.frame.branch) == pytest.approx(np.cos(0.2))
    assert pose[:3, 3] - task.target.position_m == pytest.approx(0.01 * pose[:3, 2])
    upright = pose_of(task, side, replace(SEEN, approach_angle_rad=0.7))
    assert upright[:3, :3] == pytest.approx(task.frame.axes(0.7, side))


@pytest.mark.parametrize("off", [0.0, 2e-7, -2e-7])
@pytest.mark.parametrize("turn", [0.0, 2 * np.pi, -2 * np.pi])
def test_the_closed_form_s_posture_is_on_the_programme_s_turn(off: float, turn: float) -> None:
    task = small_task()
    found = inverse_kinematics(task.robot, task.tool, pose_of(task, 1, SEEN)[None])
    for branch in np.flatnonzero(found.reachable[0]):
        near = found.joints[0, branch] + off
        near[[0, 5]] += turn
        exact = _exact_posture(task, 1, SEEN, near)
        assert exact is not None
        assert exact[0] == branch
        expected = found.joints[0, branch].copy()
        expected[[0, 5]] += turn
        assert exact[1] == pytest.approx(expected, abs=1e-12)


def test_far_from_every_branch_there_is_no_posture() -> None:
    task = small_task()
    near = np.asarray(task.thinning_joints(0.1, 1, 2))
    assert _exact_posture(task, 1, SEEN, near) is not None
    assert _exact_posture(task, 1, SEEN, near + np.array([0, 0, 0.1, 0, 0, 0])) is None
    assert _exact_posture(task, 1, replace(SEEN, strike_m=-5.0), near) is None


def test_the_row_furthest_outside_is_told() -> None:
    task = small_task()
    rows, retreats = rows_of(task), np.asarray(task.retreats_m)
    assert _broken_row(task, rows, retreats) is None
    narrow = replace(task, options=replace(task.options, limit_margin_rad=0.0))
    assert _broken_row(narrow, rows, retreats) is None
    for joint, k in ((1, 3), (4, 9)):
        for end in (rows[k, joint] + 0.01, rows[k, joint] - 0.01):
            # The one row that is beyond a limit put beside it, and another that is so by less.
            limits = task.limits[0].copy(), task.limits[1].copy()
            bent = rows.copy()
            bent[:, joint] = 0.0
            bent[k, joint] = 0.3 if end > rows[k, joint] else -0.3
            bent[k + 2, joint] = bent[k, joint] / 2
            limits[0][joint], limits[1][joint] = -0.1, 0.1
            object.__setattr__(narrow, "limits", limits)
            assert _broken_row(narrow, bent, retreats) == k


def test_a_row_off_its_line_is_broken() -> None:
    """By more than half of what the verifier allows."""
    task = small_task()
    rows, retreats = rows_of(task), np.asarray(task.retreats_m)
    for turn, broken in ((1e-4, True), (1e-10, False)):
        bent = rows.copy()
        bent[5, 1] += turn
        assert (_broken_row(task, bent, retreats) == 5) == broken


def test_a_further_row_has_the_task_s_limits() -> None:
    task = small_task()
    start = replace(start_of(task), limits=np.zeros((2, 2, 6)))
    longer = with_row(task, start, np.arange(6.0), 0.02)
    assert longer.postures[:2].tolist() == start.postures.tolist()
    assert longer.postures[2].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert longer.retreats_m.tolist() == [0.0, 0.04, 0.02]
    assert longer.limits is not None
    assert longer.limits.shape == (2, 3, 6)
    assert not longer.limits[:, :2].any()
    assert longer.limits[:, 2].tolist() == [task.lower.tolist(), task.upper.tolist()]


class Rounds:
    """A programme that stays where it starts, and rows and rates as they are told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, task: ApproachTask) -> None:
        self.task, self.given = task, list[Instance]()
        self.success, self.broken, self.room = True, list[int | None](), list[Any]()
        self.drawn: np.ndarray | None = np.stack((np.full(6, -0.7), np.full(6, 0.7)))
        self.limits: list[np.ndarray] = []
        monkeypatch.setattr(whole_cut_in, "solve_instance", self._solve)
        monkeypatch.setattr(whole_cut_in, "_broken_row", lambda *_: self.broken.pop(0))
        monkeypatch.setattr(whole_cut_in, "rate_room", lambda *_: self._room())
        monkeypatch.setattr(whole_cut_in, "slower_limits", self._slower)

    def _solve(self, robot: object, instance: Instance, options: object) -> ProgrammeResult:
        self.given.append(instance)
        return ProgrammeResult(self.success, "told", 10 ** len(self.given), instance.x0)

    def _room(self) -> np.ndarray:
        room = np.full(len(self.task.retreats_m), 0.1)
        for k, value in self.room.pop(0):
            room[k] = value
        return room

    def _slower(self, task: object, row: object, limits: np.ndarray) -> np.ndarray | None:
        self.limits.append(limits.copy())
        return self.drawn

    def solve(self) -> ProgrammeAnswer:
        return solve_whole_cut_in(self.task, start_of(self.task))

    def retreats(self) -> list[list[float]]:
        """Of the postures of each round, which stand behind 24 other parameters."""
        return [one.parameters[30 : 30 + one.programme.postures].tolist() for one in self.given]


@pytest.fixture
def rounds(monkeypatch: pytest.MonkeyPatch) -> Rounds:
    return Rounds(monkeypatch, small_task(**RELAXED))


def test_a_programme_that_fails_is_told(rounds: Rounds) -> None:
    rounds.success = False
    answer = rounds.solve()
    assert answer == ProgrammeAnswer("told", 10, 1)
    assert (answer.branch, answer.thinning) == (0, None)


def test_where_all_rows_hold_it_is_solved(rounds: Rounds) -> None:
    rounds.broken, rounds.room = [None], [[(3, 0.0)]]
    answer = rounds.solve()
    assert (answer.status, answer.iterations, answer.tool_side, answer.branch) == (
        "solved",
        10,
        1,
        2,
    )
    assert answer.thinning == pytest.approx(rounds.task.thinning_joints(0.1, 1, 2))
    assert rounds.retreats() == [[0.0, 0.04]]


def test_a_row_that_does_not_hold_becomes_a_posture(rounds: Rounds) -> None:
    rounds.broken, rounds.room = [5, None], [[]]
    assert rounds.solve().iterations == 110
    retreat = rounds.task.retreats_m[5]
    assert rounds.retreats() == [[0.0, 0.04], [0.0, 0.04, retreat]]
    second = rounds.given[1].x0
    poses = forward_kinematics(rounds.task.robot, rounds.task.tool, second[:18].reshape(3, 6))
    off = np.linalg.norm(poses[:, :3, 3] - poses[0, :3, 3], axis=1)
    assert off == pytest.approx([0.0, 0.04, retreat], abs=1e-9)
    assert second[18] == pytest.approx(0.1)


@pytest.mark.parametrize("k", [0, -1])
def test_a_row_that_is_in_the_programme_and_does_not_hold_ends_it(rounds: Rounds, k: int) -> None:
    rounds.broken = [k]
    assert rounds.solve() == ProgrammeAnswer("cut_in_infeasible", 10, 1)
    rounds.given.clear()
    rounds.broken = [5, 5]
    assert rounds.solve() == ProgrammeAnswer("cut_in_infeasible", 110, 1)


def test_a_row_that_is_too_fast_gets_closer_limits(rounds: Rounds) -> None:
    rounds.broken, rounds.room = [None, None, None], [[(5, -0.1), (7, -0.05)], [(5, -0.01)], []]
    assert rounds.solve().status == "solved"
    retreat = rounds.task.retreats_m[5]
    assert rounds.retreats() == [[0.0, 0.04], [0.0, 0.04, retreat], [0.0, 0.04, retreat]]
    own = np.stack((rounds.task.lower, rounds.task.upper))
    assert rounds.limits[0].tolist() == own.tolist()
    assert rounds.limits[1].tolist() == [[-0.7] * 6, [0.7] * 6]
    assert rounds.given[1].lower[12:18] == pytest.approx(np.full(6, -0.7), abs=1e-7)
    assert rounds.given[1].upper[12:18] == pytest.approx(np.full(6, 0.7), abs=1e-7)
    assert rounds.given[1].lower[:6] == pytest.approx(rounds.task.lower, abs=1e-7)


@pytest.mark.parametrize(("k", "posture"), [(0, 1), (-1, 0)])
def test_an_end_that_is_too_fast_gets_closer_limits_as_it_is(
    rounds: Rounds, k: int, posture: int
) -> None:
    rounds.broken, rounds.room = [None, None], [[(k, -0.1)], []]
    closer = rounds.task.upper - 1e-3
    rounds.drawn = np.stack((rounds.task.lower + 1e-3, closer))
    assert rounds.solve().status == "solved"
    assert rounds.retreats() == [[0.0, 0.04]] * 2
    ends = rounds.given[1].upper[:12].reshape(2, 6)
    drawn = [bool(np.allclose(part, closer, atol=1e-6)) for part in ends]
    assert drawn == [posture == 0, posture == 1]


def test_what_no_limit_slows_is_a_jump_of_the_wrist(rounds: Rounds) -> None:
    rounds.broken, rounds.room, rounds.drawn = [None], [[(5, -0.1)]], None
    assert rounds.solve() == ProgrammeAnswer("wrist_jump", 10, 1)


def test_after_six_rounds_it_is_given_up(rounds: Rounds) -> None:
    rounds.broken = [3, 4, 5, 6, 7, 8, 9]
    assert rounds.solve() == ProgrammeAnswer("cut_in_infeasible", 1_111_110, 1)
    assert len(rounds.given[-1].parameters) == len(rounds.given[0].parameters) + 5


def test_numbers_that_are_no_posture_of_the_closed_form_are_told(
    rounds: Rounds, monkeypatch: pytest.MonkeyPatch
) -> None:
    def elsewhere(robot: object, instance: Instance, options: object) -> ProgrammeResult:
        x = instance.x0.copy()
        x[2] += 0.2
        return ProgrammeResult(True, "told", 10, x)

    monkeypatch.setattr(whole_cut_in, "solve_instance", elsewhere)
    assert rounds.solve() == ProgrammeAnswer("not_on_the_closed_form", 10, 1)
