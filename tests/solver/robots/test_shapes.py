"""Capsules, boxes and forks: what makes sense, and where forks are."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver.robots.shapes import Box, Capsule, Forks

CAPSULE = Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.1), 0.02)
BOX = Box((0.0, 0.0, 0.0), (0.1, 0.2, 0.3))
FORKS = Forks(gap_m=0.03, length_m=0.05, thickness_m=0.004, ahead_m=0.01)


@pytest.mark.parametrize(
    "shape",
    [
        replace(CAPSULE, radius_m=0.0),
        replace(CAPSULE, radius_m=-0.1),
        replace(CAPSULE, radius_m=math.nan),
        replace(CAPSULE, radius_m=math.inf),
        replace(CAPSULE, end_m=(0.0, math.nan, 0.0)),
        replace(CAPSULE, start_m=(math.inf, 0.0, 0.0)),
        replace(BOX, size_m=(0.1, 0.0, 0.1)),
        replace(BOX, position_m=(math.nan, 0.0, 0.0)),
        replace(BOX, quaternion_xyzw=(0.0, 0.0, 0.0, 0.0)),
        replace(FORKS, gap_m=0.0),
        replace(FORKS, thickness_m=math.nan),
        replace(FORKS, length_m=math.inf),
        replace(FORKS, ahead_m=-0.001),
        replace(FORKS, ahead_m=0.05),
    ],
)
def test_shapes_without_a_size_make_no_sense(shape: Capsule | Box | Forks) -> None:
    assert not shape.makes_sense


def test_a_ball_is_a_capsule() -> None:
    assert replace(CAPSULE, end_m=CAPSULE.start_m).makes_sense
    assert CAPSULE.makes_sense
    assert BOX.makes_sense
    assert FORKS.makes_sense


def test_forks_stand_at_either_side_of_a_branch_along_y() -> None:
    one, other = FORKS.capsules()
    for rod in (one, other):
        ends = np.array((rod.start_m, rod.end_m))
        assert abs(ends[0, 0]) - rod.radius_m == pytest.approx(FORKS.gap_m / 2)
        assert 2 * rod.radius_m == FORKS.thickness_m
        assert (ends[:, 1] == 0.0).all()
        assert ends[:, 2].max() + rod.radius_m == pytest.approx(FORKS.ahead_m)
        assert ends[:, 2].min() - rod.radius_m == pytest.approx(FORKS.ahead_m - FORKS.length_m)
    assert one.start_m[0] == -other.start_m[0]


def test_forks_shorter_than_thick_are_two_balls() -> None:
    for rod in replace(FORKS, length_m=0.003, ahead_m=0.001).capsules():
        assert rod.makes_sense
