"""Peers: sweeps of the approach angle as a competent user of each library would write them.

Thinning posture only: joint limits filter, least l1 effort wins, one thread. No cut-in.
"""

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from bench.targets import TargetSet
from solver import Problem
from solver.kinematics.forward import forward_kinematics

Array = NDArray[np.float64]

CHUNK_POSES: Final = 8192
"""Poses handed over at once: fewer cost calls, more leave the cache."""


@dataclass(frozen=True)
class Peer:
    """A library that gives every inverse solution of many poses.

    Attributes:
        name: of the library.
        module: what has to be importable.
        inverse: from a problem to a function of poses, shape (n, 4, 4), that gives all solutions,
            shape (m, 6) [rad], and the pose of each, shape (m,); those outside the limits may be in
            it or not.
    """

    name: str
    module: str
    inverse: Callable[[Problem], Callable[[Array], tuple[Array, NDArray[np.int64]]]]

    @property
    def installed(self) -> bool:
        """Whether the library is there."""
        return importlib.util.find_spec(self.module) is not None


def opw_inverse(problem: Problem) -> Callable[[Array], tuple[Array, NDArray[np.int64]]]:
    """py-opw-kinematics: `Robot.reach`, all branches of many poses, limits applied by it."""
    from py_opw_kinematics import KinematicModel, Robot
    from scipy.spatial.transform import RigidTransform

    j1, j2, _, j4, _, j6 = problem.robot.joints
    # Its arm stands straight up at zero, all joints turning forward: joints 2, 3 and 5 turn the
    # other way round here, T's joint 2 is level at zero, and its tool is half a turn further.
    model = KinematicModel(
        a1=j1.a_m,
        c1=j1.d_m,
        c2=j2.a_m,
        c3=j4.d_m,
        c4=j6.d_m + problem.mounted_tool.length_m,
        offsets=(0.0, -np.pi / 2, 0.0, 0.0, 0.0, np.pi),
        flip_axes=(False, True, True, False, True, False),
    )
    arm = Robot(model, degrees=False)
    limits = np.column_stack(_limits(problem))

    def inverse(poses: Array) -> tuple[Array, NDArray[np.int64]]:
        found = arm.reach(RigidTransform.from_matrix(poses), joint_limits=limits, threads=1)
        pose, branch = np.nonzero(found.limit_margin >= 0)
        return np.asarray(found.joints[pose, branch]), pose

    return inverse


def eaik_inverse(problem: Problem) -> Callable[[Array], tuple[Array, NDArray[np.int64]]]:
    """EAIK: `DhRobot.IK_batched`, all solutions of many poses."""
    from eaik.IK_DH import DhRobot

    joints = problem.robot.joints
    d = np.array([joint.d_m for joint in joints])
    d[-1] += problem.mounted_tool.length_m
    alpha, a = np.array([j.alpha_rad for j in joints]), np.array([j.a_m for j in joints])
    arm = DhRobot(alpha, a, d)
    offsets = np.array([joint.offset_rad for joint in joints])

    def inverse(poses: Array) -> tuple[Array, NDArray[np.int64]]:
        answers = arm.IK_batched(list(poses), 1)
        solutions = [answer.Q for answer in answers]
        pose = np.repeat(np.arange(len(poses)), [len(q) for q in solutions])
        least_squares = np.concatenate([answer.is_LS for answer in answers]).astype(bool)
        q = np.concatenate(solutions) - offsets
        q -= 2 * np.pi * np.round(q / (2 * np.pi))
        return q[~least_squares], pose[~least_squares]

    return inverse


PEERS: Final[Mapping[str, Peer]] = {
    "py-opw-kinematics": Peer("py-opw-kinematics", "py_opw_kinematics", opw_inverse),
    "eaik": Peer("eaik", "eaik", eaik_inverse),
}


def installed_peers() -> list[Peer]:
    """The peers that are there."""
    return [peer for peer in PEERS.values() if peer.installed]


def least_efforts(peer: Peer, problem: Problem, targets: TargetSet, angles: int) -> Array:
    """Least effort of every target's thinning posture; infinity where nothing is inside limits."""
    inverse = peer.inverse(problem)
    lower, upper = _limits(problem)
    start, weights = np.asarray(problem.start), np.asarray(problem.joint_weights)
    phi = -np.pi + 2 * np.pi * np.arange(angles) / angles
    best = np.full(len(targets), np.inf)
    step = max(CHUNK_POSES // angles, 1)
    for first in range(0, len(targets), step):
        poses = tool_poses(targets[first : first + step], phi)
        q, pose = inverse(poses)
        usable = np.all((q >= lower) & (q <= upper), axis=1)
        effort = np.abs(q[usable] - start) @ weights
        np.minimum.at(best, first + pose[usable] // angles, effort)
    return best


def tool_poses(targets: TargetSet, phi: Array) -> Array:
    """Tool frames of every target at every angle, shape (targets * angles, 4, 4)."""
    frames = targets.frames
    cos, sin = np.cos(phi)[None, :, None], np.sin(phi)[None, :, None]
    poses = np.zeros((len(targets), len(phi), 4, 4))
    y, z = frames[:, None, 3:6], cos * frames[:, None, 6:9] + sin * frames[:, None, 9:12]
    poses[..., :3, 0], poses[..., :3, 1], poses[..., :3, 2] = np.cross(y, z), y, z
    poses[..., :3, 3], poses[..., 3, 3] = frames[:, None, :3], 1.0
    return poses.reshape(-1, 4, 4)


def random_poses(problem: Problem, count: int, seed: int) -> Array:
    """Poses of random postures inside the limits less the margin, shape (n, 4, 4)."""
    lower, upper = _limits(problem)
    q = np.random.default_rng(seed).uniform(lower, upper, (count, len(lower)))
    poses = forward_kinematics(problem.robot, problem.mounted_tool, q)
    return np.ascontiguousarray(poses)


def pose_error(peer: Peer, problem: Problem, count: int, seed: int) -> float:
    """Largest difference between poses asked for and our forward kinematics of a peer's answers."""
    poses = random_poses(problem, count, seed)
    q, pose = peer.inverse(problem)(poses)
    reached = forward_kinematics(problem.robot, problem.mounted_tool, q)
    assert np.array_equal(np.unique(pose), np.arange(count)), "a pose that exists was not solved"
    return float(np.abs(reached - poses[pose]).max())


def _limits(problem: Problem) -> tuple[Array, Array]:
    return problem.robot.limits_within(problem.options.limit_margin_rad)
