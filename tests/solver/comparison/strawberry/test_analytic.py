import math

import numpy as np
import pytest
from hypothesis import given

from solver.comparison.strawberry.analytic import outside_box, slide_span, solve_as, workspace_box
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import Point, Posture, forward_kinematics, posture_at
from solver.comparison.strawberry.tolerances import LIMIT_EXCESS_M
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import Reason
from tests.solver.comparison.strawberry.places import (
    MECHANISM,
    TARGETS,
    answered,
    near,
    postures,
    reachable,
)

ROUNDING_M = 1e-12


def allowed_thetas(target: Point, beta: float) -> np.ndarray:
    """Theta on a fine grid wherever the slides are inside their limits: a check of S_theta."""
    angles = np.radians(np.arange(-5800, 5201) / 100)
    reach = MECHANISM.l2_m + MECHANISM.l3_m * math.cos(beta)
    s21 = target[0] - MECHANISM.d_x_m + reach * np.sin(angles)
    s32 = -target[2] + MECHANISM.d_z_m - reach * np.cos(angles)
    inside = (s21 >= MECHANISM.s21.lower) & (s21 <= MECHANISM.s21.upper)
    inside &= (s32 >= MECHANISM.s32.lower) & (s32 <= MECHANISM.s32.upper)
    return np.asarray(angles[inside])


@given(postures)
def test_the_corrected_box_holds_every_tip(posture: Posture) -> None:
    tip = forward_kinematics(MECHANISM, posture)
    for value, span in zip(tip, workspace_box(MECHANISM), strict=True):
        assert span.lower - ROUNDING_M <= value <= span.upper + ROUNDING_M


def test_every_side_of_the_box_is_touched() -> None:
    """By a corner of the limits, or by an arm that hangs straight down."""
    grid = np.meshgrid(*MECHANISM.limits[:3], [*MECHANISM.theta, 0.0], [*MECHANISM.beta])
    corners = np.array(grid).reshape(5, -1).T
    tips = np.array([forward_kinematics(MECHANISM, Posture(*row)) for row in corners.tolist()])
    box = np.array(workspace_box(MECHANISM))
    assert tips.min(axis=0) == pytest.approx(box[:, 0], abs=ROUNDING_M)
    assert tips.max(axis=0) == pytest.approx(box[:, 1], abs=ROUNDING_M)


@pytest.mark.parametrize("target", TARGETS)
def test_every_target_of_table_3_is_reached_as_the_remarks_say(target: Point) -> None:
    answer = answered(solve_as(MECHANISM, target))
    assert verify_answer(MECHANISM, target, answer).verification.accepted
    span = slide_span(MECHANISM, target)
    assert answer.posture.s10_m == pytest.approx((span.lower + span.upper) / 2)
    assert answer.posture.theta_rad == 0.0
    assert answer.iterations == 0


@given(near | reachable)
def test_theta_is_the_least_that_there_is(target: Point) -> None:
    """Compared with a grid; a refusal means that the grid has no theta either."""
    answer = solve_as(MECHANISM, target)
    span = slide_span(MECHANISM, target)
    if outside_box(MECHANISM, target):
        assert isinstance(answer, Reason)
        return
    middle = (span.lower + span.upper) / 2
    sine = (target[1] - middle - MECHANISM.l1_m + MECHANISM.d_y_m) / MECHANISM.l3_m
    beta = min(max(math.asin(sine), MECHANISM.beta.lower), MECHANISM.beta.upper)
    grid = allowed_thetas(target, beta)
    if isinstance(answer, Reason):
        assert answer.code == "joint_limit"
        assert grid.size == 0
        return
    found = verify_answer(MECHANISM, target, answer)
    assert found.verification.accepted, found.verification.failures
    if grid.size:
        assert abs(answer.posture.theta_rad) <= np.abs(grid).min() + 1e-12


def test_of_two_equal_angles_the_cheaper_is_taken() -> None:
    """A target too high for an arm that hangs straight down."""
    lowest = Posture(0.3, 0.5, MECHANISM.s32.lower, 0.5, 0.3)
    target = forward_kinematics(MECHANISM, lowest)
    answer = answered(solve_as(MECHANISM, target))
    theta = answer.posture.theta_rad
    assert theta < -0.1
    other = posture_at(MECHANISM, target, -theta, answer.posture.beta_rad)
    assert other.s32_m == pytest.approx(answer.posture.s32_m, abs=LIMIT_EXCESS_M)
    assert energy_index(MECHANISM, other) > answer.index_j


@pytest.mark.parametrize(
    ("target", "axis"),
    [((2.0, 0.35, -0.33), "x"), ((0.45, -1.0, -0.33), "y"), ((0.45, 0.35, 0.2), "z")],
)
def test_targets_outside_the_box_are_refused_with_how_far(target: Point, axis: str) -> None:
    reason = solve_as(MECHANISM, target)
    assert isinstance(reason, Reason)
    assert reason.code == "out_of_reach"
    assert reason.detail.startswith(axis)
    box = dict(zip("xyz", workspace_box(MECHANISM), strict=True))[axis]
    value = target["xyz".index(axis)]
    beyond = max(box.lower - value, value - box.upper)
    assert reason.margin_m == pytest.approx(-beyond)
    assert beyond > 0


def test_a_target_that_is_no_number_is_refused() -> None:
    assert isinstance(solve_as(MECHANISM, (math.nan, 0.35, -0.33)), Reason)
