"""Intervals hold what the closed form computes, and slopes its secants."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from solver import Problem, Robot, Target
from solver.approach.bounds.enclosure import enclosure, natural_enclosure
from solver.approach.bounds.intervals import cosine, j_arc_cosine, j_arc_tangent, sine
from solver.approach.task.feasibility import posture, tool_axes
from solver.approach.task.task import approach_task
from solver.robots.model import Array
from tests.solver.kinematics.arms import arms
from tests.solver.problems import in_front_of

ARMS = arms()
COORDINATE = st.floats(-0.5, 0.5)
VECTOR = st.tuples(COORDINATE, COORDINATE, COORDINATE)
SHARE = st.floats(0.0, 1.0)


def on_turn_of(q: Array, middle: Array) -> Array:
    """The posture on the turns nearest to another."""
    return np.asarray(q + 2 * np.pi * np.round((middle - q) / (2 * np.pi)))


@settings(max_examples=800)
@example(  # the wrist centre on the waist's axis, which says nothing of an arm without offset
    arm=ARMS[0], position=(0.0, 0.0, 0.0), direction=(0.0, 0.5, 0.0), low=0.0, exponent=0.0,
    shares=(0.0, 1.0), branch=0, retreat=0.0,
)  # fmt: skip
@given(
    arm=st.sampled_from(ARMS),
    position=VECTOR,
    direction=VECTOR.filter(lambda v: math.hypot(*v) > 1e-3),
    low=st.floats(-math.pi, math.pi),
    exponent=st.floats(-9.0, 0.0),
    shares=st.tuples(SHARE, SHARE),
    branch=st.integers(0, 7),
    retreat=st.sampled_from((0.0, 0.04)),
)
def test_postures_of_a_cell_are_in_its_enclosure(
    arm: object, position: tuple[float, ...], direction: tuple[float, ...], low: float,
    exponent: float, shares: tuple[float, float], branch: int, retreat: float,
) -> None:  # fmt: skip
    problem = Problem(arm, [Target("1", position, direction)])  # type: ignore[call-overload]
    task = approach_task(problem, problem.targets[0], problem.start).for_kernels(1)
    width = 10.0**exponent
    q, tight, slopes, middle = (np.empty((6, 2)) for _ in range(4))
    reach = natural_enclosure(task, low, low + width, retreat, branch, q, slopes)
    assert enclosure(task, low, low + width, retreat, branch, tight, slopes, middle) == reach
    axes, row, rows, angles = np.empty((3, 3)), np.empty(6), [], []
    for share in shares:
        angle = min(low + share * width, low + width)
        tool_axes(task, angle, axes)
        margin = posture(task, axes, retreat, branch, row)
        if margin < 0:
            continue
        assert margin <= reach + 1e-15
        for intervals in (q, tight):
            near = on_turn_of(row, intervals.mean(axis=1))
            assert (intervals[:, 0] <= near).all()
            assert (near <= intervals[:, 1]).all()
        rows.append(near)
        angles.append(angle)
    known = tight[:, 1] - tight[:, 0] < math.pi
    if len(rows) == 2 and abs(angles[1] - angles[0]) > 1e-6:
        secants = (rows[1] - rows[0]) / (angles[1] - angles[0])
        rounding = 1e-6 * (1 + np.abs(slopes).max(axis=1))
        assert (secants >= slopes[:, 0] - rounding)[known].all()
        assert (secants <= slopes[:, 1] + rounding)[known].all()


@pytest.mark.parametrize("arm", ARMS[:4], ids=lambda arm: arm.name)
def test_small_cells_have_small_enclosures(arm: Robot) -> None:
    """An enclosure that holds everything would pass the test above."""
    (target,) = in_front_of(arm, [Target("1", (0.2, 0.05, 0.35), (-1, -1, 1))])
    problem = Problem(arm, [target])
    task = approach_task(problem, target, problem.start).for_kernels(1)
    q, slopes, middle = (np.empty((6, 2)) for _ in range(3))
    narrow = 0
    for angle in np.linspace(-3.0, 3.0, 200):
        for branch in range(8):
            reach = enclosure(task, angle, angle + 1e-4, 0.0, branch, q, slopes, middle)
            narrow += reach > 0 and float((q[:, 1] - q[:, 0]).max()) < 0.01
    assert narrow > 100


@given(low=st.floats(-20.0, 20.0), width=st.floats(0.0, 8.0), share=SHARE)
def test_sine_and_cosine_hold_their_values(low: float, width: float, share: float) -> None:
    cell = (low, low + width)
    angle = min(low + share * width, cell[1])
    assert cosine(cell)[0] <= math.cos(angle) <= cosine(cell)[1]
    assert sine(cell)[0] <= math.sin(angle) <= sine(cell)[1]


@given(low=st.floats(-1.5, 1.5), width=st.floats(0.0, 1.0), share=SHARE)
def test_arc_cosine_holds_its_values_and_slopes(low: float, width: float, share: float) -> None:
    value = min(low + share * width, low + width)
    if not -1.0 < value < 1.0:
        return
    angles, slopes = j_arc_cosine(((low, low + width), (1.0, 1.0)))
    assert angles[0] <= math.acos(value) <= angles[1]
    slope = -1.0 / math.sqrt((1.0 - value) * (1.0 + value))
    assert slopes[0] <= slope * (1 - 1e-12)
    assert slope * (1 + 1e-12) <= slopes[1]


@given(corner=st.tuples(COORDINATE, COORDINATE), size=st.tuples(SHARE, SHARE),
       shares=st.tuples(SHARE, SHARE))  # fmt: skip
def test_arc_tangent_holds_its_values(
    corner: tuple[float, float], size: tuple[float, float], shares: tuple[float, float]
) -> None:
    box = [(c, c + s) for c, s in zip(corner, size, strict=True)]
    y, x = (min(a + s * (b - a), b) for (a, b), s in zip(box, shares, strict=True))
    low, high = j_arc_tangent((box[0], (0.0, 0.0)), (box[1], (0.0, 0.0)))[0]
    turns = [math.atan2(y, x) + 2 * math.pi * k for k in (-1, 0, 1)]
    assert any(low <= angle <= high for angle in turns)
    origin_inside = all(a <= 0.0 <= b for a, b in box)
    assert (high - low > 2 * math.pi) == origin_inside
