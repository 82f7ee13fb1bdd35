"""Gravity and inertia as each joint feels them, from the masses of a model; batched NumPy."""

from dataclasses import dataclass, replace

import numpy as np

from solver.kinematics.forward import link_transforms
from solver.robots.model import Array, Link, Robot, Tool

GRAVITY_M_S2 = 9.80665


@dataclass(frozen=True)
class JointLoads:
    """Loads of every joint in every posture, shape (..., n).

    Attributes:
        gravity: torque that holds the arm still [N m]; force for a prismatic joint [N].
        inertia: felt when the joint moves alone, rotor included [kg m2]; mass for a prismatic
            joint [kg].
    """

    gravity: Array
    inertia: Array


def joint_loads(robot: Robot, tool: Tool, q: Array) -> JointLoads:
    """Loads by virtual work: g_i = sum m_k g (J_ik . up), M_ii = sum m_k |J_ik|^2 + z_i . I_k z_i.

    J_ik is the velocity of link k's centre of mass for a unit rate of joint i; only links behind a
    joint count. Gravity acts along the base frame's -z.

    Args:
        robot: an arm whose every link has masses (`Robot.has_masses`).
        tool: its tool; its mass counts half-way along its length.
        q: joint vectors, shape (..., n) [rad or m].
    """
    links = _links(robot, tool)
    frames = link_transforms(robot, replace(tool, length_m=0.0), q)
    axes, origins = frames[..., :-1, :3, 2], frames[..., :-1, :3, 3]
    turns = frames[..., 1:, :3, :3]
    local = np.array([link.centre_m for link in links])
    centres = np.einsum("...kij,kj->...ki", turns, local) + frames[..., 1:, :3, 3]
    masses = np.array([link.mass_kg for link in links])
    turning = robot.turning[:, None, None]
    arms = centres[..., None, :, :] - origins[..., :, None, :]
    spread = np.broadcast_to(axes[..., :, None, :], arms.shape)
    rates = turning * np.cross(spread, arms) + (1 - turning) * spread
    behind = np.triu(np.ones((len(links), len(links))))
    gravity = GRAVITY_M_S2 * np.sum(behind * masses * rates[..., 2], axis=-1)
    inertias = np.array([link_tensor(link) for link in links])
    turned = np.einsum("...kij,kjl,...kml->...kim", turns, inertias, turns)
    spin = np.einsum("...ij,...kjm,...im->...ik", axes, turned, axes) * turning[..., 0]
    moving = masses * np.sum(rates**2, axis=-1) + spin
    drives = np.array([link.drive_inertia for link in links])
    return JointLoads(np.asarray(gravity), np.asarray(np.sum(behind * moving, axis=-1) + drives))


def _links(robot: Robot, tool: Tool) -> list[Link]:
    links = [joint.link for joint in robot.joints if joint.link is not None]
    assert len(links) == len(robot.joints), "the caller checks has_masses"
    return [*links[:-1], _with_tool(links[-1], tool)]


def _with_tool(link: Link, tool: Tool) -> Link:
    """The last link with the tool's mass on it, as one body about one centre."""
    total = link.mass_kg + tool.mass_kg
    if total == 0.0:
        return link
    places = np.array([link.centre_m, (0.0, 0.0, tool.length_m / 2)])
    weights = np.array([link.mass_kg, tool.mass_kg])
    centre = weights @ places / total
    tensor = link_tensor(link)
    for mass, place in zip(weights, places, strict=True):
        tensor = tensor + mass * shift_tensor(place - centre)
    x, y, z = (float(value) for value in centre)
    return replace(link, mass_kg=total, centre_m=(x, y, z), inertia_kg_m2=tensor_entries(tensor))


def shift_tensor(arm: Array) -> Array:
    """Inertia of a unit point mass at the end of an arm, shape (3,) to (3, 3) (parallel axes)."""
    return np.asarray(arm @ arm * np.eye(3) - np.outer(arm, arm))


def tensor_entries(tensor: Array) -> tuple[float, float, float, float, float, float]:
    """The entries xx, yy, zz, xy, xz, yz of a symmetric tensor."""
    xx, yy, zz = (float(value) for value in np.diag(tensor))
    return xx, yy, zz, float(tensor[0, 1]), float(tensor[0, 2]), float(tensor[1, 2])


def link_tensor(link: Link) -> Array:
    """A link's inertia about its centre of mass, shape (3, 3) [kg m2]."""
    xx, yy, zz, xy, xz, yz = link.inertia_kg_m2
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
