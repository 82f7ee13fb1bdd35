"""The closed form: all eight branches of many poses, and the peers' inverses of the same poses."""

import numpy as np

from bench.measure import Row, alternating, row, scaled
from bench.peers import CHUNK_POSES, Array, installed_peers, pose_error, random_poses
from bench.targets import data_set_3
from solver.kinematics.spherical_wrist import (
    BRANCHES,
    all_branches,
    inverse_kinematics,
    wrist_geometry,
)

WANTED_US = 0.6


def measure(quick: bool) -> list[Row]:
    """Microseconds a pose on one core, poses of random postures inside the limits."""
    problem = data_set_3().problem()
    count, runs = (CHUNK_POSES, 3) if quick else (16 * CHUNK_POSES, 9)
    poses = random_poses(problem, count, seed=1)
    geometry = wrist_geometry(problem.robot, problem.mounted_tool)
    joints, margins = np.empty((count, BRANCHES, 6)), np.empty((count, BRANCHES // 2))
    singular = np.empty((count, BRANCHES), dtype=np.bool_)
    actions = {
        "closed form, all eight branches": lambda: all_branches(
            geometry, poses, joints, margins, singular
        ),
        "the same with its answer's memory": lambda: inverse_kinematics(
            problem.robot, problem.mounted_tool, poses
        ),
    }
    notes = dict.fromkeys(actions, f"{count} poses")
    few = poses[:CHUNK_POSES]
    for peer in installed_peers():
        inverse = peer.inverse(problem)
        actions[peer.name] = lambda inverse=inverse: inverse(few)  # type: ignore[misc]
        error = pose_error(peer, problem, 1000, seed=2)
        notes[peer.name] = f"{CHUNK_POSES} poses; answers agree with our model to {error:.0e}"
    times = alternating(actions, runs)
    rows = []
    for name, values in times.items():
        own = name in list(actions)[:2]
        each = scaled(values, 1e6 / _size(own, poses, few))
        wanted = WANTED_US if name == next(iter(actions)) else None
        rows.append(row(name, each, "µs a pose", at_most=wanted, note=notes[name]))
    return rows


def _size(own: bool, poses: Array, few: Array) -> int:
    return len(poses if own else few)
