import math
from importlib import resources

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.comparison.strawberry.mechanism import (
    Point,
    Posture,
    forward_kinematics,
    link_points,
    load_mechanism,
    parse_mechanism,
    posture_at,
)
from solver.exceptions import InvalidRobot
from tests.solver.comparison.strawberry.places import MECHANISM, postures, reachable

DOCUMENT = (resources.files("solver.comparison.strawberry") / "mechanism.toml").read_bytes()


def transform(axis: str, angle: float, move: tuple[float, float, float]) -> np.ndarray:
    """A move and then a turn about x or y."""
    cosine, sine = math.cos(angle), math.sin(angle)
    turns = {
        "x": np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]]),
        "y": np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]),
    }
    matrix = np.eye(4)
    matrix[:3, :3] = turns[axis]
    matrix[:3, 3] = move
    return matrix


@given(postures)
def test_forward_kinematics_are_those_of_a_chain_of_frames(posture: Posture) -> None:
    """Theta turns about y, beta about the x axis that theta has turned; links hang along -z."""
    m, q = MECHANISM, posture
    offsets = (m.d_x_m, m.l1_m - m.d_y_m, m.d_z_m)
    chain = (
        transform("x", 0.0, (q.s21_m, q.s10_m, -q.s32_m))
        @ transform("y", q.theta_rad, offsets)
        @ transform("x", q.beta_rad, (0.0, 0.0, -m.l2_m))
    )
    tip = (chain @ (0.0, 0.0, -m.l3_m, 1.0))[:3]
    assert forward_kinematics(m, q) == pytest.approx(tuple(tip), abs=1e-12)


@given(postures)
def test_links_keep_their_lengths_and_end_at_the_tip(posture: Posture) -> None:
    points = link_points(MECHANISM, posture)
    lengths = np.linalg.norm(np.diff(points[1:], axis=0), axis=1)
    assert lengths == pytest.approx([MECHANISM.l1_m, MECHANISM.l2_m, MECHANISM.l3_m])
    assert tuple(points[-1]) == pytest.approx(forward_kinematics(MECHANISM, posture), abs=1e-12)


@given(reachable, st.floats(*MECHANISM.theta), st.floats(*MECHANISM.beta))
def test_posture_at_a_target_is_at_the_target(target: Point, theta: float, beta: float) -> None:
    posture = posture_at(MECHANISM, target, theta, beta)
    assert forward_kinematics(MECHANISM, posture) == pytest.approx(target, abs=1e-12)


def test_limits_are_those_of_the_experiments() -> None:
    """S 5.1, beta from 0 to 73 degrees."""
    millimetres = [(75, 660), (80, 920), (61, 251)]
    degrees = [(-58, 52), (0, 73)]
    for span, limits in zip(MECHANISM.limits[:3], millimetres, strict=True):
        assert span == pytest.approx(tuple(value * 1e-3 for value in limits))
    for span, limits in zip(MECHANISM.limits[3:], degrees, strict=True):
        assert span == pytest.approx(tuple(map(math.radians, limits)))
    assert MECHANISM.reset == pytest.approx((0.075, 0.08, 0.061, 0.0, 0.0))


def test_what_is_unknown_is_marked_and_says_what_is_known() -> None:
    assert [unknown.name for unknown in MECHANISM.unknowns] == [
        "d_x", "d_y", "d_z", "m3_g", "h_extra",
    ]  # fmt: skip
    assert all(unknown.known for unknown in MECHANISM.unknowns)


def test_it_is_no_robot_with_an_approach() -> None:
    from solver import robot_names

    assert MECHANISM.name not in robot_names()


@pytest.mark.parametrize(
    ("printed", "broken"),
    [
        ("s10_mm = [75.0, 660.0]", "s10_mm = [660.0, 75.0]"),
        ("s10_mm = [75.0, 660.0]", "s10_mm = [75.0]"),
        ("s10_mm = [75.0, 660.0]", "s10_mm = [75.0, inf]"),
        ("s10_mm = [75.0, 660.0]", ""),
        ("s10_mm = [75.0, 660.0]", "s10_inch = [75.0, 660.0]"),
        ("theta_deg = [-58.0, 52.0]", "theta_deg = [10.0, 52.0]"),
        ("beta_deg = [0.0, 73.0]", "beta_deg = [-85.0, 73.0]"),
        ("beta_deg = [0.0, 73.0]", "beta_deg = [0.0, 90.0]"),
        ("l3_mm = 60.0", "l3_mm = 0.0"),
        ("l3_mm = 60.0", "l3_mm = 60.0\nl4_mm = 1.0"),
        ("value = 7.3575", "value = 15.0"),
        ("[unknown.d_x]", "[unknown.d_w]"),
        ("value = 50.0", "value = -1.0"),
        ('unit = "N"', 'unit = "lbf"'),
        ("lifted_n = 14.715", "lifted_n ="),
    ],
)
def test_files_that_make_no_sense_are_refused(printed: str, broken: str) -> None:
    text = DOCUMENT.decode()
    assert text.count(printed) >= 1
    with pytest.raises(InvalidRobot):
        parse_mechanism(text.replace(printed, broken, 1).encode())


def test_the_file_is_read_once() -> None:
    assert load_mechanism() is load_mechanism()
    assert parse_mechanism(DOCUMENT) == load_mechanism()
