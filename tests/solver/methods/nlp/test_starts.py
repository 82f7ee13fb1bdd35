"""A start is a thinning posture and the standby behind it, seen from the target."""

import math

import numpy as np
import pytest

from solver.approach.task.relaxation import Placement
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.methods.nlp.starts import start_at
from solver.methods.nlp.whole_cut_in import pose_of
from tests.solver.methods.synthetic import small_task


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("strike", [0.0, 0.004])
@pytest.mark.parametrize("lean", [0.0, 0.05])
def test_a_start_is_where_its_posture_stands(side: int, strike: float, lean: float) -> None:
    task = small_task(2, symmetric_tool=True, strike_zone_m=0.02, tilt_tolerance_rad=0.2)
    placed = Placement(0.25, strike, lean * task.frame.sideways)
    found = inverse_kinematics(task.robot, task.tool, pose_of(task, side, placed)[None])
    branch = int(np.flatnonzero(found.reachable[0])[0])
    thinning = found.joints[0, branch]
    start = start_at(task, side, branch, thinning)
    assert start.tool_side == side
    assert start.approach_angle_rad == pytest.approx(0.25)
    assert start.lower_rad == pytest.approx(0.25 - math.pi)
    assert start.upper_rad == pytest.approx(0.25 + math.pi)
    assert start.strike_m == pytest.approx(strike, abs=1e-9)
    assert start.swing_rad == pytest.approx(placed.swing_rad, abs=1e-7)
    assert start.retreats_m.tolist() == [0.0, 0.04]
    assert start.postures[0] == pytest.approx(thinning)
    pose, behind = forward_kinematics(task.robot, task.tool, start.postures)
    assert behind[:3, 3] == pytest.approx(pose[:3, 3] - 0.04 * pose[:3, 2], abs=1e-9)
    assert behind[:3, :3] == pytest.approx(pose[:3, :3], abs=1e-9)
    assert start.limits is None
