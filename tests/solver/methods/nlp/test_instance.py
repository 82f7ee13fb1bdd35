"""A task's numbers for a programme, and what is read from the numbers it ends with."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver.approach.task.relaxation import rotation
from solver.methods.nlp.formulation import Shape, build_programme
from solver.methods.nlp.instance import Instance, Start, make_instance, placed, shape_of
from tests.solver.methods.synthetic import ROBOT, small_task

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.2}
FOLLOWING = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)


def start_of(task, rows: int = 0, **changes: object) -> Start:  # type: ignore[no-untyped-def]
    postures = np.linspace(-0.9, 0.9, 6 * (2 + rows)).reshape(-1, 6)
    swing = 0.05 * task.frame.outward - 0.1 * task.frame.sideways
    retreats = np.linspace(0.0, 0.04, 2 + rows)
    start = Start(-1, 0.3, -2.0, 2.5, postures, retreats, 0.015, swing)
    return replace(start, **changes)  # type: ignore[arg-type]


def instance_of(task, start: Start, following=None, **more: object) -> Instance:  # type: ignore[no-untyped-def]
    shape = shape_of(task, coupled=following is not None, rows=len(start.postures) - 2)
    return make_instance(task, build_programme(task.robot, shape), start, following)


@pytest.mark.parametrize(
    ("options", "shape"),
    [
        ({}, Shape("l1")),
        ({"norm": "l2", "strike_zone_m": 0.01}, Shape("l2", strike=True)),
        ({"tilt_tolerance_rad": 0.1}, Shape("l1", tilt=True)),
    ],
)
def test_the_shape_is_what_the_options_ask_for(options: dict[str, object], shape: Shape) -> None:
    task = small_task(**options)
    assert shape_of(task) == shape
    assert shape_of(task, coupled=True, rows=2) == replace(shape, coupled=True, rows=2)


@pytest.mark.parametrize("rows", [0, 1])
@pytest.mark.parametrize("following", [None, FOLLOWING])
def test_parameters_stand_in_the_programme_s_order(
    rows: int, following: tuple[float, ...] | None
) -> None:
    task = small_task(joint_weights=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), **RELAXED)
    start = start_of(task, rows)
    instance = instance_of(task, start, following)
    frame = task.frame
    expected = [
        *task.target.position_m, *(-frame.branch), *frame.outward, *frame.sideways,
        *task.reference, *(following or (0.0,) * 6), 1.0, 2.0, 3.0, 4.0, 5.0, 6.0,
        *start.retreats_m, task.tool.length_m, 0.02, math.tan(0.1),
    ]  # fmt: skip
    assert instance.parameters.tolist() == pytest.approx(expected)
    assert instance.parameters.shape == (instance.programme.nlp["p"].numel(),)


def test_the_start_is_told_in_shares_and_slacks_are_travels() -> None:
    task = small_task(**RELAXED)
    start = start_of(task)
    instance = instance_of(task, start, FOLLOWING)
    length = math.hypot(0.05, 0.1)
    share = math.tan(length / 2) / math.tan(0.1)
    shares = np.array([0.05, -0.1]) / length * share
    expected = np.concatenate((start.postures.ravel(), [0.3, 0.75], shares))
    assert instance.x0[:16] == pytest.approx(expected)
    travels = np.abs([start.postures[0] - task.reference, start.postures[1] - FOLLOWING])
    assert instance.x0[16:] == pytest.approx(travels.ravel())
    assert instance.slack_references.tolist() == [*task.reference, *FOLLOWING]
    upright = instance_of(task, replace(start, swing_rad=np.zeros(3)))
    assert upright.x0[14:16].tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    "options", [{}, {"strike_zone_m": 0.02}, {"tilt_tolerance_rad": 0.2}, RELAXED]
)
def test_bounds_are_limits_drawn_in_where_something_is_relaxed(options: dict[str, float]) -> None:
    task = small_task(**options)
    instance = instance_of(task, start_of(task))
    inset = 1e-8 if options else 0.0
    lower, upper = [*task.lower + inset] * 2 + [-2.0], [*task.upper - inset] * 2 + [2.5]
    if "strike_zone_m" in options:
        lower, upper = [*lower, 0.0], [*upper, 1.0]
    if "tilt_tolerance_rad" in options:
        lower, upper = [*lower, -1.0, -1.0], [*upper, 1.0, 1.0]
    free = [math.inf] * 6
    assert instance.lower.tolist() == pytest.approx([*lower, *(-math.inf for _ in free)], abs=1e-12)
    assert instance.upper.tolist() == pytest.approx([*upper, *free], abs=1e-12)


def test_a_start_may_have_limits_of_its_own() -> None:
    task = small_task()
    limits = np.stack((np.full((2, 6), -0.5), np.full((2, 6), 0.25)))
    limits[1, 1] = 0.125
    start = start_of(task, limits=limits)
    instance = instance_of(task, start)
    assert instance.lower[:12].tolist() == [-0.5] * 12
    assert instance.upper[:12].tolist() == [0.25] * 6 + [0.125] * 6
    own = start_of(task).limits_of(task)
    assert own.shape == (2, 2, 6)
    assert all(own[0, k].tolist() == task.lower.tolist() for k in range(2))
    assert all(own[1, k].tolist() == task.upper.tolist() for k in range(2))


def test_constraints_are_equations_and_then_what_is_not_negative() -> None:
    task = small_task(**RELAXED)
    instance = instance_of(task, start_of(task))
    lower, upper = instance.constraint_bounds
    assert lower.tolist() == [0.0] * 25
    assert upper.tolist() == [0.0] * 12 + [math.inf] * 13


@pytest.mark.parametrize(("eta", "inside"), [((0.9, -1.2), (0.6, -0.8)), ((0.3, 0.4), (0.3, 0.4))])
def test_what_is_outside_is_brought_inside(
    eta: tuple[float, float], inside: tuple[float, float]
) -> None:
    """Variables to their bounds, a lean into its circle, and slacks to what they bound."""
    task = small_task(**RELAXED)
    instance = instance_of(task, start_of(task))
    x = instance.x0.copy()
    x[2], x[8], x[12], x[13], x[14:16], x[16:] = 9.0, -9.0, 3.0, -0.5, eta, 0.0
    brought = instance.inside(x)
    assert brought[[2, 8, 12, 13]].tolist() == [
        instance.upper[2], instance.lower[8], 2.5, 0.0,
    ]  # fmt: skip
    # Both shares are first at most one.
    clipped = np.clip(eta, -1.0, 1.0)
    assert brought[14:16] == pytest.approx(clipped / max(1.0, np.hypot(*clipped)))
    assert np.hypot(*brought[14:16]) <= 1.0 + 1e-12
    assert brought[16:] == pytest.approx(np.abs(brought[:6] - task.reference))
    assert np.array_equal(instance.inside(brought), brought)
    assert x[2] == 9.0


@pytest.mark.parametrize("strike", [False, True])
@pytest.mark.parametrize("eta", [(0.0, 0.0), (0.5, -0.25), (1.2, 0.9), (0.0, 1.0)])
def test_where_the_tool_is_placed(strike: bool, eta: tuple[float, float]) -> None:
    """The swing turns by twice the arc tangent, and by no more than is tolerated."""
    zone = 0.02 if strike else 0.0
    task = small_task(tilt_tolerance_rad=0.2, strike_zone_m=zone)
    programme = build_programme(ROBOT, shape_of(task))
    share = [0.25] if strike else []
    x = np.concatenate((np.zeros(12), [0.4], share, eta, np.zeros(6)))
    seen = placed(task, programme, x)
    assert (seen.approach_angle_rad, seen.strike_m) == (0.4, 0.25 * zone)
    length = math.hypot(*eta)
    turn = min(2 * math.atan(math.tan(0.1) * length), 0.2)
    along = np.array(eta) @ (task.frame.outward, task.frame.sideways)
    expected = along / max(length, 1e-300) * turn
    assert seen.swing_rad == pytest.approx(expected, abs=1e-12)
    np.testing.assert_allclose(
        rotation(seen.swing_rad) @ task.frame.branch, rotation(expected) @ task.frame.branch
    )


@pytest.mark.parametrize(("share", "strike"), [(-0.1, 0.0), (0.5, 0.01), (1.1, 0.02)])
def test_a_strike_is_inside_its_zone(share: float, strike: float) -> None:
    task = small_task(strike_zone_m=0.02)
    programme = build_programme(ROBOT, shape_of(task))
    seen = placed(task, programme, np.concatenate((np.zeros(12), [0.4, share], np.zeros(6))))
    assert seen.strike_m == strike
    assert not seen.swing_rad.any()


def test_a_start_and_where_it_is_placed_are_the_same() -> None:
    task = small_task(**RELAXED)
    start = start_of(task)
    instance = instance_of(task, start)
    seen = placed(task, instance.programme, instance.x0)
    assert seen.approach_angle_rad == pytest.approx(0.3)
    assert seen.strike_m == pytest.approx(0.015)
    assert seen.swing_rad == pytest.approx(start.swing_rad)
