"""What touches and how near it comes: cost of a posture, and MuJoCo's opinion of a million."""

import time
from collections.abc import Callable

import numpy as np

from bench.measure import Row, row, scaled
from bench.scenes import leaves, mixed, postures, twigs
from bench.second_opinion import MujocoArm
from solver import load_robot
from solver.robots.model import Array, Robot, Tool
from solver.scene.arm_body import arm_body, body_reach_m
from solver.scene.many_postures import nearest_pairs, touching
from solver.scene.obstacles import Scene
from solver.scene.packing import Obstacles, pack_scene

CLEARANCE_M, UP_TO_M = 0.005, 0.05
POINTS = 100_000
RUNS = 15
AT_CONTACT_M = 1e-6
"""Nearer to contact than that postures are counted apart."""

TWIGS = {14: (0.3, 0.8), 134: (0.38, 2.5), 1334: (0.47, 10.0)}
"""By their number, of which every second has two pieces: where they begin [m], so that enough
postures are free, and what is wanted [us]."""

POINTS_US, NEAREST_US, FIRST_MS = 3.0, 10.0, 150.0


def measure(quick: bool) -> list[Row]:
    """Free postures of the table-top arm among twigs, and among points; MuJoCo among all."""
    robot = load_robot("tabletop")
    tool = robot.tools[0]
    count = 300 if quick else 20_000
    rows = []
    for number, (nearest_m, wanted) in TWIGS.items():
        scene = Scene(twigs(number, number, nearest_m))
        obstacles = pack_scene(scene, body_reach_m(robot, tool, UP_TO_M))
        capsules = sum(len(list(chain.capsules())) for chain in scene.chains)
        name = f"whether a free posture touches, {capsules:,} capsules"
        rows.append(_touch(name, robot, tool, obstacles, count, wanted))
    points = 1000 if quick else POINTS
    cloud, times = Scene((), (), (), (leaves(7, points, clusters=60),)), []
    for _ in range(6):
        began = time.perf_counter()
        obstacles = pack_scene(cloud, body_reach_m(robot, tool, UP_TO_M))
        touching(arm_body(robot, tool), obstacles, CLEARANCE_M, postures(robot, 1, 1))
        times.append(time.perf_counter() - began)
    name = f"whether a free posture touches, {points:,} points"
    rows.append(_touch(name, robot, tool, obstacles, count, POINTS_US))
    free = _free(robot, tool, obstacles, count)
    name = f"nearest pair up to {UP_TO_M * 100:g} cm, {points:,} points"
    spent = _spent_us(lambda: nearest_pairs(arm_body(robot, tool), obstacles, UP_TO_M, free), free)
    rows.append(row(name, spent, "us", at_most=NEAREST_US))
    name = f"from {points:,} points in memory to the first posture looked at"
    rows.append(row(name, scaled(times[1:], 1e3), "ms", at_most=FIRST_MS))
    return [*rows, *_second_opinion(robot, 500 if quick else 1_000_000)]


def _touch(
    name: str, robot: Robot, tool: Tool, obstacles: Obstacles, count: int, wanted: float
) -> Row:
    free = _free(robot, tool, obstacles, count)
    body = arm_body(robot, tool)
    spent = _spent_us(lambda: touching(body, obstacles, CLEARANCE_M, free), free)
    note = f"{1 - len(free) / count:.0%} of random postures touch, and leave early"
    return row(name, spent, "us", at_most=wanted, note=note)


def _free(robot: Robot, tool: Tool, obstacles: Obstacles, count: int) -> Array:
    drawn = postures(robot, 2, count)
    return drawn[~touching(arm_body(robot, tool), obstacles, CLEARANCE_M, drawn)]


def _spent_us(look: Callable[[], object], free: Array) -> list[float]:
    look()
    times = []
    for _ in range(RUNS):
        began = time.perf_counter()
        look()
        times.append(1e6 * (time.perf_counter() - began) / len(free))
    return times


def _second_opinion(robot: Robot, count: int) -> list[Row]:
    tools, scenes = robot.tools, 10
    disagreeing = at_contact = touched = unseen = 0
    for k in range(scenes):
        tool, scene = tools[k % len(tools)], mixed(100 + 3 * k)
        second, obstacles = (
            MujocoArm(robot, tool, scene),
            pack_scene(scene, body_reach_m(robot, tool, UP_TO_M)),
        )
        drawn = postures(robot, 200 + k, count // scenes)
        pairs = nearest_pairs(arm_body(robot, tool), obstacles, UP_TO_M, drawn)
        near = np.abs(pairs.distances_m) < AT_CONTACT_M
        says = np.array([second.distance(q) < 0.0 for q in drawn])
        mine = pairs.distances_m < 0.0
        apart = np.flatnonzero((says != mine) & ~near)
        through = sum(bool(mine[n]) and second.runs_through_a_box(drawn[n]) for n in apart)
        disagreeing, unseen = disagreeing + len(apart) - through, unseen + through
        at_contact += int(np.count_nonzero(near))
        touched += int(np.count_nonzero(mine))
    name = f"postures on which MuJoCo disagrees, of {count:,}"
    note = (
        f"{touched / count:.0%} touch; {at_contact} within a micrometre of contact left out, and "
    )
    note += f"{unseen} in which a link's axis runs through a box, which MuJoCo does not see"
    return [row(name, disagreeing, "", runs=count, at_most=0, note=note)]
