import math
from dataclasses import replace

import numpy as np
import pytest

from solver import Robot, load_robot
from solver.kinematics.dynamics import GRAVITY_M_S2, joint_loads, link_tensor
from solver.kinematics.forward import link_transforms
from solver.robots.model import Array

STEP = 1e-6


def potential_energy(robot: Robot, q: Array) -> Array:
    """From heights alone: sum of m g z of the links and of the tool, half-way along its length."""
    tool = robot.tools[0]
    frames = link_transforms(robot, replace(tool, length_m=0.0), q)
    energy = np.zeros(len(q))
    for i, joint in enumerate(robot.joints):
        assert joint.link is not None
        energy += joint.link.mass_kg * (frames[:, i + 1] @ (*joint.link.centre_m, 1.0))[:, 2]
    energy += tool.mass_kg * (frames[:, -1] @ (0.0, 0.0, tool.length_m / 2, 1.0))[:, 2]
    return np.asarray(GRAVITY_M_S2 * energy)


def kinetic_energy(robot: Robot, q: Array, joint: int) -> Array:
    """For a unit rate of one joint, by differences of frames: sum of m v^2 / 2 + w I w / 2."""
    tool = replace(robot.tools[0], length_m=0.0)
    step = np.zeros(len(robot.joints))
    step[joint] = STEP
    before, after = (link_transforms(robot, tool, q + sign * step) for sign in (-1, 1))
    here = link_transforms(robot, tool, q)
    energy = np.zeros(len(q))
    for i, entry in enumerate(robot.joints):
        assert entry.link is not None
        centre = (*entry.link.centre_m, 1.0)
        speed = ((after - before)[:, i + 1] @ centre)[:, :3] / (2 * STEP)
        spin = np.swapaxes(here[:, i + 1, :3, :3], 1, 2) @ (after - before)[:, i + 1, :3, :3]
        rates = np.stack((spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]), axis=1) / (2 * STEP)
        energy += entry.link.mass_kg * np.sum(speed**2, axis=1) / 2
        energy += np.einsum("ki,ij,kj->k", rates, link_tensor(entry.link), rates) / 2
    place = (0.0, 0.0, robot.tools[0].length_m / 2, 1.0)
    speed = ((after - before)[:, -1] @ place)[:, :3] / (2 * STEP)
    return np.asarray(energy + robot.tools[0].mass_kg * np.sum(speed**2, axis=1) / 2)


@pytest.mark.parametrize("name", ["tabletop", "puma560", "puma560_rail"])
def test_loads_are_the_derivatives_of_the_energies(name: str) -> None:
    robot = load_robot(name)
    q = np.random.default_rng(5).uniform(robot.lower, robot.upper, (20, len(robot.joints)))
    loads = joint_loads(robot, robot.tools[0], q)
    for i, joint in enumerate(robot.joints):
        step = np.zeros(len(robot.joints))
        step[i] = STEP
        slope = potential_energy(robot, q + step) - potential_energy(robot, q - step)
        np.testing.assert_allclose(loads.gravity[:, i], slope / (2 * STEP), atol=2e-6)
        assert joint.link is not None
        inertia = 2 * kinetic_energy(robot, q, i) + joint.link.drive_inertia
        np.testing.assert_allclose(loads.inertia[:, i], inertia, rtol=1e-6, atol=1e-9)


def test_the_puma_carries_what_was_measured() -> None:
    """Armstrong et al. 1986, the constants of gravity: 37.2 N m of the level upper arm, 8.44 N m of
    the level forearm.
    """
    robot = load_robot("puma560")
    bare = replace(robot.tools[0], mass_kg=0.0)
    upper_arm_level = joint_loads(robot, bare, np.zeros(6)).gravity
    assert upper_arm_level[1] == pytest.approx(37.2, rel=0.02)
    forearm_level = joint_loads(robot, bare, np.array([0, math.pi / 2, -math.pi, 0, 0, 0])).gravity
    assert abs(forearm_level[2]) == pytest.approx(8.44, rel=0.05)
