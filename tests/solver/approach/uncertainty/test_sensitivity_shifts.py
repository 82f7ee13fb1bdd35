"""Rates of one posture by differences, and postures of a shifted tool, on two arms."""

import math

import numpy as np
import pytest

from solver import Robot
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import one_branch, wrist_geometry
from solver.robots.model import Array
from solver.robots.rigid import inverse
from tests.solver.kinematics.arms import arms

ARMS = [arms()[0], arms()[2], arms()[6], arms()[15]]
STEP = 1e-6
LEVER = 0.03


def placed(arm: Robot, seed: int) -> tuple[Array, Array, int, Array]:
    """Position and axes in the mount's frame, branch and posture, away from singular ones."""
    rng, tool = np.random.default_rng(seed), arm.tools[0]
    geometry = wrist_geometry(arm, tool)
    while True:
        q = rng.uniform(arm.lower, arm.upper)
        pose = inverse(arm.mount) @ forward_kinematics(arm, tool, q)
        axes, found = np.ascontiguousarray(pose[:3, :3]), np.empty(6)
        for branch in range(8):
            reach = one_branch(geometry, pose[:3, 3], axes, branch, found)
            apart = np.remainder(found - q + np.pi, 2 * np.pi) - np.pi
            bent = abs(math.sin(q[4] + geometry.offsets[4]))
            if np.abs(apart).max() < 1e-6 and reach > 0.02 and bent > 0.2:
                return pose[:3, 3].copy(), axes, branch, found


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)
@pytest.mark.parametrize("seed", range(4))
def test_rates_are_differences_of_the_closed_form(arm: Robot, seed: int) -> None:
    geometry = wrist_geometry(arm, arm.tools[0])
    position, axes, branch, q = placed(arm, seed)
    rates, reach_rates = np.full((6, 4), np.nan), np.full(4, np.nan)
    lever, turn = geometry.tool_length + LEVER, axes[:, 1].copy()
    reach = joint_rates(geometry, q, axes, lever, turn, rates, reach_rates)
    at = np.empty(6)
    assert reach == pytest.approx(one_branch(geometry, position, axes, branch, at), abs=1e-12)
    ahead = position + LEVER * axes[:, 2]
    for k in range(4):
        ends, reaches = np.empty((2, 6)), np.empty(2)
        for n, step in enumerate((-STEP, STEP)):
            moved, turned = position.copy(), axes.copy()
            if k < 3:
                moved[k] += step
            else:
                z = np.cos(step) * axes[:, 2] + np.sin(step) * np.cross(turn, axes[:, 2])
                turned = np.ascontiguousarray(np.column_stack((np.cross(turn, z), turn, z)))
                moved = ahead - LEVER * z
            reaches[n] = one_branch(geometry, moved, turned, branch, ends[n])
        change = np.remainder(ends[1] - ends[0] + np.pi, 2 * np.pi) - np.pi
        assert rates[:, k] == pytest.approx(change / (2 * STEP), rel=1e-5, abs=1e-4)
        assert reach_rates[k] == pytest.approx((reaches[1] - reaches[0]) / (2 * STEP), abs=1e-5)


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)
def test_singular_postures_have_rates_that_are_numbers(arm: Robot) -> None:
    """Held at a millionth's sine: a straight wrist, a stretched elbow, the waist's axis."""
    geometry = wrist_geometry(arm, arm.tools[0])
    _, axes, _, q = placed(arm, 1)
    straight, stretched = q.copy(), q.copy()
    straight[4] = -geometry.offsets[4]
    stretched[2] = -geometry.offsets[2] - geometry.beta
    for posture, joints in ((straight, (3, 5)), (stretched, (1, 2))):
        rates, reach_rates = np.empty((6, 4)), np.empty(4)
        joint_rates(geometry, posture, axes, 0.1, axes[:, 1].copy(), rates, reach_rates)
        assert np.isfinite(rates).all()
        assert np.isfinite(reach_rates).all()
        assert np.abs(rates[list(joints)]).max() > 1e4


@pytest.mark.parametrize("arm", ARMS[:2], ids=lambda arm: arm.name)
@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_a_shifted_posture_is_on_the_turn_next_to_another(arm: Robot, turns: int) -> None:
    geometry = wrist_geometry(arm, arm.tools[0])
    position, axes, branch, q = placed(arm, 2)
    delta, near = np.array([0.001, -0.002, 0.003]), q + 2 * np.pi * turns * np.arange(6)
    found, alone = np.full(6, np.nan), np.empty(6)
    reach = shifted(geometry, position, delta, axes, branch, near, found)
    assert reach == one_branch(geometry, position + delta, axes, branch, alone)
    assert np.abs(found - near).max() < 0.2
    apart = np.remainder(found - alone + np.pi, 2 * np.pi) - np.pi
    assert apart == pytest.approx(np.zeros(6), abs=1e-9)
