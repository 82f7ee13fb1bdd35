"""What is packed besides plain fields: limits as cosines, steps, and places on the circle."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import Arc
from solver.approach.task.packed import (
    COLUMNS,
    COS_HALF,
    COS_MIDDLE,
    NEVER_LIMITS,
    NO_ROOM,
    SIN_MIDDLE,
    SQUARED,
    ApproachCircle,
    jump_cosines,
    tool_place,
    unpack_circle,
)
from solver.approach.task.task import ApproachTask
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

TASK = small_task(2, symmetric_tool=True)


def test_steps_of_joints_as_cosines() -> None:
    retreats = np.array([0.04, 0.039, 0.0389, 0.0])
    travel = JOINT_RATE_RAD_M * np.array([0.001, 0.0001, 0.0389])
    expected = np.where(travel < math.pi, np.cos(travel), NEVER_LIMITS)
    assert jump_cosines(retreats) == pytest.approx(expected)
    assert jump_cosines(list(retreats)) == pytest.approx(expected)
    assert len(set(expected.tolist())) == 3


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("retreat", [0.0, 0.03])
def test_the_tool_stands_behind_the_target_on_its_circle(side: int, retreat: float) -> None:
    circle = unpack_circle_of(TASK, side)
    for angle in (-2.0, 0.0, 0.7):
        place, x, y, z = interpreted(tool_place)(circle, math.cos(angle), math.sin(angle), retreat)
        turn = TASK.robot.mount[:3, :3]
        axes = TASK.frame.axes(angle, side)
        assert turn @ np.column_stack((x, y, z)) == pytest.approx(axes)
        wanted = np.asarray(TASK.target.position_m) - retreat * axes[:, 2]
        assert turn @ np.array(place) + TASK.robot.mount[:3, 3] == pytest.approx(wanted)


def unpack_circle_of(task: ApproachTask, side: int) -> ApproachCircle:
    numbers = task.packed(side).numbers
    fields = {}
    for name in ApproachCircle._fields:
        fields[name] = tuple(numbers[COLUMNS[name] : COLUMNS[name] + 3].tolist())
    found = ApproachCircle(**fields)
    assert tuple(unpack_circle(numbers)) == tuple(found)
    return found


def test_limits_are_cosines_about_their_middle() -> None:
    numbers = TASK.packed(1).numbers
    offsets = np.asarray(TASK.for_kernels(1).geometry.offsets)
    middle, half = (TASK.lower + TASK.upper) / 2 + offsets, (TASK.upper - TASK.lower) / 2
    assert numbers[COS_MIDDLE : COS_MIDDLE + 6] == pytest.approx(np.cos(middle))
    assert numbers[SIN_MIDDLE : SIN_MIDDLE + 6] == pytest.approx(np.sin(middle))
    assert numbers[COS_HALF : COS_HALF + 6] == pytest.approx(np.cos(half))
    assert (numbers[SQUARED], small_task(norm="l2").packed(1).numbers[SQUARED]) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("lower", "upper", "cosine"), [(-4.0, 4.0, NEVER_LIMITS), (0.3, 0.1, NO_ROOM), (0.2, 0.2, 1.0)]
)
def test_a_whole_turn_never_limits_and_no_range_has_no_room(
    lower: float, upper: float, cosine: float
) -> None:
    task = replace(TASK)
    task.__dict__["limits"] = np.full(6, lower), np.full(6, upper)
    assert task.packed(1).numbers[COS_HALF : COS_HALF + 6] == pytest.approx(np.full(6, cosine))
    assert NEVER_LIMITS < -1.0
    assert NO_ROOM > 1.0


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_task_with_some_of_its_arcs(symmetric: bool) -> None:
    task = small_task(2, symmetric_tool=symmetric)
    sides = (1, -1) if symmetric else (1,)
    arcs = [Arc(sides[-1], 5, 0.1, 0.3), Arc(1, 2, -0.4, 0.2)]
    numbers, retreats, steps, places, branches, lower, upper = task.packed_arcs(arcs)
    assert numbers.tolist() == [task.packed(side).numbers.tolist() for side in sides]
    assert retreats.tolist() == list(task.retreats_m)
    assert steps == pytest.approx(jump_cosines(task.retreats_m))
    assert places.tolist() == [len(sides) - 1, 0]
    assert branches.tolist() == [5, 2]
    assert (lower.tolist(), upper.tolist()) == ([0.1, -0.4], [0.3, 0.2])
