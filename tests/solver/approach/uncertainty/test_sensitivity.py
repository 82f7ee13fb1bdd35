import numpy as np
import pytest

from solver import Robot
from solver.approach.uncertainty.sensitivity import joint_rates
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics, wrist_geometry
from solver.robots.model import Array
from tests.solver.kinematics.arms import arms

STEP = 1e-6
LEVER = 0.03


def _moved(pose: Array, k: int, step: float) -> Array:
    """The pose shifted along a base axis, or turned about its y through a point ahead."""
    moved = pose.copy()
    if k < 3:
        moved[k, 3] += step
        return moved
    _, y, z = pose[:3, :3].T
    ahead = pose[:3, 3] + LEVER * z
    turned = np.cos(step) * z + np.sin(step) * np.cross(y, z)
    moved[:3, :3] = np.column_stack((np.cross(y, turned), y, turned))
    moved[:3, 3] = ahead - LEVER * turned
    return moved


@pytest.mark.parametrize("arm", arms()[::4], ids=lambda arm: arm.name)
def test_rates_are_those_of_differences(arm: Robot) -> None:
    rng = np.random.default_rng(61)
    tool = arm.tools[0]
    geometry = wrist_geometry(arm, tool)
    rates, reach_rates = np.empty((6, 4)), np.empty(4)
    compared = 0
    for q in rng.uniform(arm.lower, arm.upper, (60, 6)):
        pose = forward_kinematics(arm, tool, q)
        found = inverse_kinematics(arm, tool, pose[None])
        apart = np.abs(np.remainder(found.joints[0] - q + np.pi, 2 * np.pi) - np.pi).max(axis=1)
        branch = int(apart.argmin())
        margin = found.reach_margin_m[0, branch // 2]
        if abs(np.sin(q[4] + arm.joints[4].offset_rad)) < 0.1 or margin < 0.01:
            continue
        axes = np.ascontiguousarray(pose[:3, :3])
        lever = geometry.tool_length + LEVER
        reach = joint_rates(geometry, q, axes, lever, axes[:, 1].copy(), rates, reach_rates)
        assert reach == pytest.approx(margin, abs=1e-9)
        poses = np.array([[_moved(pose, k, s * STEP) for s in (1, -1)] for k in range(4)])
        moved = inverse_kinematics(arm, tool, poses.reshape(8, 4, 4))
        joints = moved.joints[:, branch].reshape(4, 2, 6)
        change = np.remainder(joints[:, 0] - joints[:, 1] + np.pi, 2 * np.pi) - np.pi
        np.testing.assert_allclose(rates.T, change / (2 * STEP), rtol=1e-5, atol=1e-4)
        reaches = moved.reach_margin_m[:, branch // 2].reshape(4, 2)
        difference = (reaches[:, 0] - reaches[:, 1]) / (2 * STEP)
        np.testing.assert_allclose(reach_rates, difference, atol=1e-5)
        compared += 1
    assert compared > 30
