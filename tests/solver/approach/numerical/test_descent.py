"""The direct search of arms without a closed form, and what it asks of a step."""

import math
from typing import Any

import numpy as np
import pytest

from solver import Robot
from solver.approach.numerical import descent as module
from solver.approach.numerical.descent import _bound, descend, effort_of, holds, lead_back
from solver.approach.numerical.multi_start import PoseFamily
from solver.approach.numerical.sweep import pose_family
from solver.kinematics.chain_rates import rates_behind
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.numerical import chain_of, postures_behind
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.approach.numerical.test_multi_start import ROBOTS, known, task_of
from tests.solver.interpreted import interpret, interpreted

N = 3


def family(reference: tuple[float, ...], low: float = -2.0, high: float = 2.0) -> PoseFamily:
    three = np.zeros(3)
    return PoseFamily(
        three, three, three, three, three, np.full(N, low), np.full(N, high), np.array(reference)
    )


@pytest.mark.parametrize(
    ("value", "ahead", "staying", "expected"),
    [
        (1.0, 0.1, False, (0.5, 2.0)),
        (0.0, 0.1, False, (-2.0, 0.5)),
        (0.5, 0.1, False, (0.5, 2.0)),
        (0.5, -0.1, False, (-2.0, 0.5)),
        (0.5, 0.1, True, (0.5, 0.5)),
        (2.0, -0.1, True, (2.0, 2.0)),
        (-2.0, 0.1, True, (-2.0, -2.0)),
        (1.0, 0.1, True, (0.5, 2.0)),
    ],
)
def test_a_joint_goes_no_further_than_to_a_limit_or_its_reference(
    value: float, ahead: float, staying: bool, expected: tuple[float, float]
) -> None:
    low, high = np.full(N, np.nan), np.full(N, np.nan)
    _bound(family((9.0, 0.5, 9.0)), value, 1, ahead, staying, low, high)
    assert (low[1], high[1]) == expected
    assert np.isnan(low[[0, 2]]).all()
    outside = np.empty(N), np.empty(N)
    _bound(family((0.0, 5.0, 0.0)), 1.0, 1, ahead, False, *outside)
    assert (outside[0][1], outside[1][1]) == (-2.0, 2.0)


@pytest.mark.parametrize(("squared", "expected"), [(False, 1 * 0.5 + 2 * 1.0 + 3 * 0.25),
                                                   (True, 0.25 + 2.0 + 3 * 0.0625)])  # fmt: skip
def test_effort_is_weighted_travel(squared: bool, expected: float) -> None:
    weights = np.array([1.0, 2.0, 3.0])
    q = np.array([0.5, -1.0, 0.75])
    assert effort_of(family((0.0, 0.0, 0.5)), weights, squared, q) == pytest.approx(expected)


class Told:
    """A search in which every posture is at the target, unless it is told otherwise."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.tried: list[list[float]] = []
        self.angles: list[float] = []
        self.reached = True
        self.holding: Any = lambda q: True
        interpret(monkeypatch, module, lead_back=self._lead, holds=self._holds)

    def _holds(self, chain: Any, family: Any, retreats: Any, q: np.ndarray) -> Any:
        return self.holding(q)

    def _lead(self, chain: Any, cell: PoseFamily, angle: float, q: np.ndarray) -> float:
        self.tried.append(q.tolist())
        self.angles.append(float(angle))
        assert np.all((cell.lower <= q) & (q <= cell.upper))
        return angle + 0.5 if self.reached else math.nan

    def run(self, q: list[float], directions: list[list[float]]) -> tuple[float, list[float]]:
        reference = (0.0, 0.0, 0.0)
        at = np.array(q)
        angle = interpreted(descend)(
            None, family(reference), None, np.ones(N), False, np.array(directions), 1.0, at
        )
        return float(angle), at.tolist()


def test_a_cheaper_step_is_taken_and_the_next_is_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    ways = [[1.0, 0, 0, 0.5], [0.0, 1.0, 0, 0.0], [0, 0, 1.0, -0.5]]
    angle, q = told.run([1.0, -1.0, 1.0], ways)
    # Forward is dearer, so back: 0.2, then 1.6 and 2.56 times that.
    assert told.tried[0] == pytest.approx([1.2, -1.0, 1.0])
    assert told.tried[1] == pytest.approx([0.8, -1.0, 1.0])
    assert told.tried[2] == pytest.approx([0.8, -0.68, 1.0])
    assert told.tried[3] == pytest.approx([0.8, -0.68, 1.512])
    assert q == pytest.approx([0.8, -0.68, 0.488])
    assert told.angles[:2] == pytest.approx([1.1, 0.9])
    assert angle == pytest.approx(1.0 - 0.1 + 0.5 + 0.5 + 0.256 + 0.5)


def test_a_step_that_fails_is_shortened(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    told.holding = lambda q: False
    _, q = told.run([1.0, 1.0, 1.0], [[1.0, 0, 0, 0]] * 3)
    assert q == [1.0, 1.0, 1.0]
    forward = [one[0] - 1.0 for one in told.tried[::2]]
    assert forward == pytest.approx([0.2, 0.2 * 0.85, 0.2 * 0.85**2])
    told.tried.clear()
    told.reached, told.holding = False, lambda q: True
    assert told.run([1.0, 1.0, 1.0], [[1.0, 0, 0, 0]] * 3) == (1.0, [1.0, 1.0, 1.0])
    assert len(told.tried) == 6
    # Below 1e-5 it ends.
    told.tried.clear()
    told.run([1.0, 1.0, 1.0], [[1.0, 0, 0, 0]] * 500)
    assert len(told.tried) == 2 * math.ceil(math.log(1e-5 / 0.2) / math.log(0.85))


def test_a_joint_stops_at_its_reference_and_stays_there_every_second_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch)
    _, q = told.run([0.1, 1.0, 1.0], [[-1.0, -1.0, 0, 0], [-1.0, -1.0, 0, 0], [1.0, -1, 0, 0]])
    assert told.tried[0] == pytest.approx([0.0, 0.8, 1.0])
    assert told.tried[1] == pytest.approx([0.0, 0.48, 1.0])
    assert told.tried[2] == pytest.approx([0.512, 0.0, 1.0])
    assert q == pytest.approx([0.0, 0.48, 1.0])


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_what_leads_back_is_on_the_target_and_a_cut_in_holds_or_not(robot: Robot) -> None:
    checked = {True: 0, False: 0}
    for k in range(8):
        task, posture, angle = known(robot, k)
        chain, retreats = chain_of(robot, task.tool), np.linspace(task.retreats_m[0], 0.0, 3)
        own = pose_family(task, 1, task.lower, task.upper)
        moved = np.clip(posture + 0.02, task.lower, task.upper)
        other = lead_back(chain, own, angle, moved)
        if not math.isnan(other):
            pose = forward_kinematics(robot, task.tool, moved)
            assert pose[:3, 3] == pytest.approx(task.target.position_m, abs=1e-9)
            assert pose[:3, :3] == pytest.approx(task.frame.axes(other, 1), abs=1e-9)
        rows = postures_behind(robot, task.tool, posture, retreats)
        poses = forward_kinematics(robot, task.tool, rows)
        line = poses[-1, :3, 3] - np.outer(retreats, poses[-1, :3, 2])
        off = np.linalg.norm(poses[:, :3, 3] - line, axis=1).max()
        rate = float((rates_behind(robot, task.tool, rows) * robot.turning).max())
        expected = off < 1e-6 and task.inside(rows).min() >= 0.0 and rate <= JOINT_RATE_RAD_M
        assert holds(chain, own, retreats, posture) == expected
        checked[bool(expected)] += 1
        # With the limits drawn in to before one of its rows it does not.
        if expected:
            for i in (1, len(posture) - 1):
                tight = own._replace(upper=own.upper.copy(), lower=own.lower.copy())
                tight.upper[i] = rows[:, i].max() - 1e-6
                assert not holds(chain, tight, retreats, posture)
                tight.upper[i], tight.lower[i] = own.upper[i], rows[:, i].min() + 1e-6
                assert not holds(chain, tight, retreats, posture)
    assert checked[True] >= 2


def test_far_from_every_posture_nothing_leads_back() -> None:
    task = task_of(ROBOTS[0])
    chain = chain_of(task.robot, task.tool)
    far = pose_family(task, 1, task.lower, task.upper)._replace(position=np.array([9.0, 0, 0]))
    assert math.isnan(lead_back(chain, far, 0.0, np.asarray(task.reference).copy()))


def test_a_search_gains_and_stays_on_the_target() -> None:
    for k in range(8):
        task, posture, angle = known(ROBOTS[0], k)
        chain, retreats = chain_of(task.robot, task.tool), np.linspace(task.retreats_m[0], 0.0, 3)
        own = pose_family(task, 1, task.lower, task.upper)
        if holds(chain, own, retreats, posture):
            break
    weights, q = np.ones(6), posture.copy()
    directions = np.random.default_rng(2).normal(size=(24, 7))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    angle = descend(chain, own, retreats, weights, False, directions, angle, q)
    assert effort_of(own, weights, False, q) < effort_of(own, weights, False, posture)
    pose = forward_kinematics(task.robot, task.tool, q)
    assert pose[:3, 3] == pytest.approx(task.target.position_m, abs=1e-9)
    assert pose[:3, :3] == pytest.approx(task.frame.axes(angle, 1), abs=1e-9)
    assert holds(chain, own, retreats, q)


def test_what_leads_back_looks_from_the_angle_that_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before every step anew; as often as eight times."""
    task, posture, _ = known(ROBOTS[0], 0)
    own = pose_family(task, 1, task.lower, task.upper)
    angles = [0.4321]

    def stand_in(chain: Any, of: Any, axes: np.ndarray, share: float, q: Any, *_: Any) -> float:
        assert axes == pytest.approx(task.frame.axes(angles[-1], 1))
        assert share == 0.0
        angles.append(angles[-1] + 0.1)
        return 0.1

    interpret(monkeypatch, module, step_towards=stand_in)
    chain = chain_of(task.robot, task.tool)
    assert math.isnan(interpreted(lead_back)(chain, own, 0.4321, posture.copy()))
    assert len(angles) == 9
