"""The verifier's inverse kinematics, against the kernel and against forward kinematics."""

import numpy as np
import pytest

from solver import Robot
from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.verification.postures import LEAN, REACH, arms_of
from tests.solver.kinematics.arms import arms

BEHIND_M = np.array([0.05, 0.02, 0.0])


@pytest.mark.parametrize("robot", arms(), ids=lambda arm: arm.name)
def test_postures_are_those_of_the_closed_form_on_every_branch(robot: Robot) -> None:
    tool = robot.tools[0]
    rng = np.random.default_rng(7)
    drawn = rng.uniform(robot.lower, robot.upper, (300, 6))
    found = inverse_kinematics(robot, tool, many_poses(robot, tool, drawn))
    rows, branches = np.nonzero(found.reachable & ~found.singular)
    postures = found.joints[rows, branches]
    arms_there = arms_of(robot, tool, branches, postures)
    near = np.broadcast_to(postures.T[..., None], (6, len(rows), len(BEHIND_M)))
    told = arms_there.postures(arms_there.centres_behind(BEHIND_M), near)
    reached = told[REACH] > 1e-6
    assert reached[:, -1].mean() > 0.9
    # As the kernel has it, or where the wrist centre comes near the waist's axis.
    across = np.hypot(*arms_there.centres_behind(BEHIND_M)[:2, :, -1])
    beside = across - abs(arms_there.geometry.shoulder)
    inside = np.minimum(found.reach_margin_m[rows, branches // 2], beside)
    assert told[REACH, :, -1] == pytest.approx(inside, abs=1e-12)
    poses = many_poses(robot, tool, postures)
    for k, behind in enumerate(BEHIND_M):
        there = poses.copy()
        there[:, :3, 3] -= behind * poses[:, :3, 2]
        kernel = inverse_kinematics(robot, tool, there)
        own = np.arange(len(rows)), branches
        bent = np.hypot(*told[LEAN, :, k]) > 1e-3
        looked_at = reached[:, k] & bent & kernel.reachable[own]
        apart = np.remainder(told[:6, :, k].T - kernel.joints[own] + np.pi, 2 * np.pi) - np.pi
        assert np.abs(apart[looked_at]).max() < 1e-9
        assert looked_at.mean() > 0.3
    # On the turns of the postures that they are near to.
    assert np.abs(told[:6, reached[:, -1], -1].T - postures[reached[:, -1]]).max() < np.pi
