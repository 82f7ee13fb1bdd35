"""Seeded scenes around the table-top arm, and postures of an arm."""

import numpy as np

from solver.robots.model import Robot
from solver.robots.shapes import Box
from solver.scene.obstacles import Array, Block, Chain, Plane, Points, Scene

NEAREST_M, FURTHEST_M = 0.22, 0.5
"""How far from the base obstacles begin: the arm passes some and touches others."""


def places(rng: np.random.Generator, count: int, nearest_m: float = NEAREST_M) -> Array:
    """Points above the table, shape (count, 3) [m]."""
    found = rng.normal(size=(count, 3))
    found /= np.linalg.norm(found, axis=1)[:, None]
    found *= rng.uniform(nearest_m, FURTHEST_M, (count, 1))
    found[:, 2] = np.abs(found[:, 2]) + 0.05
    return np.asarray(found)


def twigs(seed: int, count: int, nearest_m: float = NEAREST_M) -> tuple[Chain, ...]:
    """Branches of one or two pieces of some 15 cm."""
    rng = np.random.default_rng(seed)
    chains = []
    for k, start in enumerate(places(rng, count, nearest_m)):
        steps = rng.normal(size=(1 + k % 2, 3)) * 0.08
        points = np.vstack((start, start + np.cumsum(steps, axis=0))).tolist()
        chains.append(Chain(f"branch {k}", tuple((x, y, z) for x, y, z in points), 0.006))
    return tuple(chains)


def blocks(seed: int, count: int) -> tuple[Block, ...]:
    """Boxes turned anyhow."""
    rng = np.random.default_rng(seed)
    made = []
    for k, (x, y, z) in enumerate(places(rng, count).tolist()):
        width, depth, height = rng.uniform(0.01, 0.15, 3).tolist()
        a, b, c, d = rng.normal(size=4).tolist()
        made.append(Block(f"box {k}", Box((x, y, z), (width, depth, height), (a, b, c, d))))
    return tuple(made)


def leaves(seed: int, count: int, radius_m: float = 0.005, clusters: int = 12) -> Points:
    """A cloud of points in clusters of some 6 cm."""
    rng = np.random.default_rng(seed)
    around = places(rng, clusters)[rng.integers(0, clusters, count)]
    return Points("points", around + rng.normal(size=(count, 3)) * 0.03, radius_m)


def mixed(seed: int) -> Scene:
    """Some of everything."""
    wall = Plane("wall", (0.0, 0.42, 0.0), (0.1, -2.0, 0.3))
    return Scene(twigs(seed, 12), blocks(seed + 1, 4), (wall,), (leaves(seed + 2, 40),))


def postures(robot: Robot, seed: int, count: int) -> Array:
    """Anywhere inside the limits, shape (count, joints) [rad]."""
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (count, len(robot.joints)))
