"""How far a target may move: that far in every direction, and no further in some."""

import math

import numpy as np
import pytest

from solver.approach.task.constraints import LIMITS, REACH
from solver.approach.uncertainty import displacement
from solver.approach.uncertainty.displacement import (
    displacement_margin,
    other_rows,
    rows_displacement_margin,
    rows_displacement_margins,
)
from solver.approach.uncertainty.nearest_limit import behind, first_order
from solver.approach.uncertainty.robustness import (
    approach_margin,
    bears_uncertainty,
    path_displacement_margin,
)
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.kinematics.forward import forward_kinematics
from solver.robots.rigid import inverse
from tests.solver.interpreted import interpret, interpreted
from tests.solver.methods.synthetic import small_task

PLACES = [(0, 0.1), (2, 0.2), (2, 0.45), (3, -0.9), (4, 0.0), (1, 0.4)]


class Approach:
    """On branch 2 of a target of data set 3; some limits may be drawn in."""

    def __init__(self, index: int, angle: float, rows: int = 4) -> None:
        task = small_task(index)
        self.retreats = np.linspace(0.04, 0.0, rows)
        kernels = task.for_kernels(1)
        self.geometry = kernels.geometry
        self.lower, self.upper = kernels.lower.copy(), kernels.upper.copy()
        self.rows = task.postures(angle, 1, 2, self.retreats)
        pose = forward_kinematics(task.robot, task.tool, self.rows[-1])
        self.pose = np.ascontiguousarray(inverse(task.robot.mount) @ pose)
        self.axes = np.ascontiguousarray(self.pose[:3, :3])

    def margin(self) -> tuple[float, int, int]:
        margin, row, joint = rows_displacement_margin(
            self.geometry, self.lower, self.upper, self.pose, self.retreats, 2, self.rows
        )
        return float(margin), int(row), int(joint)

    def room(self, delta: np.ndarray) -> float:
        """The least of all limits in all rows after a shift; below zero where one is broken."""
        least, place, at = math.inf, np.empty(3), np.empty(6)
        for n, retreat in enumerate(self.retreats):
            behind(self.pose, retreat, place)
            reach = shifted(self.geometry, place, delta, self.axes, 2, self.rows[n], at)
            inside = min((at - self.lower).min(), (self.upper - at).min())
            same = math.sin(at[4] + self.geometry.offsets[4]) * math.sin(
                self.rows[n, 4] + self.geometry.offsets[4]
            )
            least = min(least, reach, inside, same)
        return float(least)

    def directions(self) -> np.ndarray:
        """Along which some limit comes nearest, to first order, and others."""
        found = []
        for q in self.rows:
            rates, reach_rates = np.empty((6, 4)), np.empty(4)
            joint_rates(self.geometry, q, self.axes, 0.0, np.zeros(3), rates, reach_rates)
            found += [*rates[:, :3], -reach_rates[:3]]
        vectors = np.array([*found, *np.random.default_rng(1).normal(size=(20, 3))])
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
        return np.concatenate((vectors, -vectors))


@pytest.mark.parametrize(("index", "angle"), PLACES)
def test_no_shift_that_is_shorter_breaks_a_limit_and_some_longer_one_does(
    index: int, angle: float
) -> None:
    approach = Approach(index, angle)
    margin, row, joint = approach.margin()
    assert 0 <= row < 4
    assert 0 <= joint <= REACH
    if approach.room(np.zeros(3)) < 0.0:
        assert margin == 0.0
        return
    assert margin > 0.0
    directions = approach.directions()
    assert min(approach.room(0.995 * margin * way) for way in directions) >= -1e-6
    assert min(approach.room(1.05 * margin * way) for way in directions) < 0.0


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_limit_that_is_drawn_near_is_the_one_that_is_met(joint: int, side: str) -> None:
    """In the row where it is nearest, at its room over its slope."""
    approach = Approach(2, 0.2)
    beyond = approach.rows[:, joint]
    if side == "lower":
        approach.lower[joint] = beyond.min() - 0.002
    else:
        approach.upper[joint] = beyond.max() + 0.002
    margin, row, which = approach.margin()
    assert which == joint
    distances = np.empty((4, LIMITS))
    for n in range(4):
        first_order(
            approach.geometry, approach.lower, approach.upper, approach.rows[n], approach.axes,
            np.empty((6, 4)), np.empty(4), distances[n],
        )  # fmt: skip
    kind = 2 * joint + (side == "upper")
    assert row == distances[:, kind].argmin()
    assert margin == pytest.approx(distances[row, kind], rel=0.05)
    assert approach.room(np.zeros(3)) > 0.0


def test_where_a_limit_is_broken_already_nothing_is_left() -> None:
    approach = Approach(2, 0.2)
    approach.upper[3] = approach.rows[1, 3]
    assert approach.margin()[0] == 0.0
    approach.upper[3] = approach.rows[:, 3].max() - 0.01
    margin, row, joint = approach.margin()
    assert (margin, row, joint) == (0.0, int(approach.rows[:, 3].argmax()), 3)


@pytest.mark.parametrize("joint", [3, 5])
@pytest.mark.parametrize("off", [0.5, -0.7, 1.2])
def test_limits_of_the_wrist_bend_around_a_straight_one(joint: int, off: float) -> None:
    """A wrist that is nearly straight turns joints 4 and 6 by half a turn in little more."""
    approach = Approach(2, 0.2, rows=1)
    approach.rows = approach.rows[-1:].copy()
    approach.rows[0, 4] = 0.06 - approach.geometry.offsets[4]
    task = small_task(2)
    pose = forward_kinematics(task.robot, task.tool, approach.rows[0])
    approach.pose = np.ascontiguousarray(inverse(task.robot.mount) @ pose)
    approach.axes = np.ascontiguousarray(approach.pose[:3, :3])
    approach.retreats = np.zeros(1)
    approach.lower, approach.upper = approach.rows[0] - 2.5, approach.rows[0] + 2.5
    if off > 0:
        approach.upper[joint] = approach.rows[0, joint] + off
    else:
        approach.lower[joint] = approach.rows[0, joint] + off
    margin, row, which = approach.margin()
    assert row == 0
    assert which in (3, 4, 5)
    rates, reach_rates = np.empty((6, 4)), np.empty(4)
    joint_rates(
        approach.geometry, approach.rows[0], approach.axes, 0.0, np.zeros(3), rates, reach_rates
    )
    along, across = np.linalg.qr(rates[[4, 3], :3].T)[0].T
    turns = np.linspace(0.0, 2 * np.pi, 120)
    ways = np.outer(np.cos(turns), along) + np.outer(np.sin(turns), across)
    assert min(approach.room(0.97 * margin * way) for way in ways) >= -1e-6


def test_several_cut_ins_and_whole_approaches_tell_the_same() -> None:
    task = small_task(2)
    retreats = np.asarray(task.retreats_m)
    kernels, rows = task.for_kernels(1), np.empty((len(retreats), 6))
    margins = np.full(2, np.nan)
    angles = (0.2, 0.4)
    paths = np.stack([task.postures(angle, 1, 2, retreats) for angle in angles])
    poses = np.stack([forward_kinematics(task.robot, task.tool, path[-1]) for path in paths])
    poses = np.ascontiguousarray(inverse(task.robot.mount) @ poses)
    rows_displacement_margins(
        kernels.geometry, kernels.lower, kernels.upper, poses, retreats, np.array([2, 2]), paths,
        margins,
    )  # fmt: skip
    for k, angle in enumerate(angles):
        whole, row, joint = displacement_margin(kernels, angle, 2, rows)
        assert margins[k] == pytest.approx(whole, rel=1e-9)
        assert rows == pytest.approx(paths[k], abs=1e-9)
        assert 0 <= row < len(retreats)
        assert 0 <= joint <= REACH
        assert approach_margin(task, angle, 1, 2) == pytest.approx(whole, rel=1e-9)
        thinning = task.thinning_joints(angle, 1, 2)
        told = path_displacement_margin(task.robot, task.tool, task.options, 2, thinning)
        assert told == pytest.approx(whole, rel=1e-6)
    # One that is not feasible bears nothing.
    assert displacement_margin(kernels, 2.5, 2, rows) == (0.0, 0, 0)
    assert bears_uncertainty(task, 0.2, 1, 2)


def test_other_rows_are_asked_until_none_breaks(monkeypatch: pytest.MonkeyPatch) -> None:
    """At each displacement that is found the others are looked at anew."""
    rows = np.repeat(np.arange(3.0)[:, None], 6, axis=1)
    # By row and displacement: a joint beyond its limits, or the reach.
    breaks = {(1, 1.0): (2, 11.0), (2, 2.0): (REACH, -0.1), (0, 3.0): (4, -10.5)}
    lengths = {(1, 2): (4.0, 2.0), (2, REACH): (3.0, 3.0), (0, 4): (3.5, 9.0)}
    asked: list[tuple[int, int, float]] = []

    def stand_in(g: object, position: object, delta: np.ndarray, axes: object, branch: int,
                 near: np.ndarray, at: np.ndarray) -> float:  # fmt: skip
        at[:] = 0.0
        joint, value = breaks.get((int(near[0]), float(delta[0])), (0, 0.0))
        if joint == REACH:
            return value
        at[joint] = value
        return 1.0

    def distance(g: object, position: object, axes: object, branch: int, q: np.ndarray,
                 kind: int, limit: float, delta: np.ndarray) -> float:  # fmt: skip
        assert not delta.any()
        asked.append((int(q[0]), kind, limit))
        length, delta[0] = lengths[int(q[0]), kind]
        return length

    interpret(monkeypatch, displacement, shifted=stand_in, limit_distance=distance)
    low, high, start = np.full(6, -10.0), np.full(6, 10.0), np.array([1.0, 0.0, 0.0])
    found = interpreted(other_rows)(
        None, low, high, np.eye(4), np.zeros(3), 2, rows, 5.0, 0, 0, start
    )
    # The last one is no nearer, so it is left as it was.
    assert found == (3.0, 2, REACH)
    assert asked == [(1, 2, 10.0), (2, REACH, 0.0), (0, 4, -10.0)]
