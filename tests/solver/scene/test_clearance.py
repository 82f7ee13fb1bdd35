"""What touches, and how near it comes, against MuJoCo and against plain distances."""

import math

import numpy as np
import pytest

from bench.scenes import blocks, leaves, mixed, postures, twigs
from bench.second_opinion import MujocoArm
from solver import Robot
from solver.kinematics.forward import forward_kinematics, link_transforms
from solver.robots.shapes import Box, Capsule
from solver.scene.arm_body import arm_body, body_reach_m
from solver.scene.clearance import (
    NOBODY,
    BodyScratch,
    body_scratch,
    nearest,
    nearest_of_itself,
    touches,
)
from solver.scene.obstacles import Array, Block, Chain, Plane, Points, Scene
from solver.scene.packing import pack_scene


def scratch_of(robot: Robot, tool: str | None = None) -> BodyScratch:
    """Working memory for a robot with one of its tools."""
    mounted = robot.tool(tool or robot.default_tool)
    assert mounted is not None
    scratch: BodyScratch = body_scratch(arm_body(robot, mounted))
    return scratch


MUJOCO_M = 1e-6
"""Nearer to contact than that nobody is asked: MuJoCo's own steps end there [m]."""

SCENES = {
    "twigs": Scene(twigs(1, 60)),
    "boxes": Scene((), blocks(2, 6)),
    "plane": Scene((), (), (Plane("wall", (0.0, 0.25, 0.0), (0.2, -1.0, 0.1)),)),
    "points": Scene((), (), (), (leaves(3, 600),)),
    "many twigs": Scene(twigs(4, 500, nearest_m=0.47)),
    "mixed": mixed(5),
}


@pytest.mark.parametrize("tool", ["laser", "scaffold"])
@pytest.mark.parametrize("name", SCENES)
def test_mujoco_agrees_on_what_touches(tabletop: Robot, name: str, tool: str) -> None:
    mounted = tabletop.tool(tool)
    assert mounted is not None
    second = MujocoArm(tabletop, mounted, SCENES[name])
    body, scratch = arm_body(tabletop, mounted), scratch_of(tabletop, tool)
    obstacles = pack_scene(SCENES[name], body_reach_m(tabletop, mounted, 0.05))
    touching = asked = 0
    for q in postures(tabletop, 6, 300):
        depth, _, _ = nearest(body, obstacles, 0.0, q, scratch)
        if abs(depth) < MUJOCO_M and depth < 0.0:
            continue
        asked += 1
        found = touches(body, obstacles, 0.0, q, scratch)
        assert found == (second.distance(q) < 0.0)
        assert found == (depth < 0.0)
        touching += found
    assert 10 < touching < asked - 10


def test_a_thin_rod_through_a_box_touches_though_mujoco_sees_nothing(tabletop: Robot) -> None:
    """MuJoCo 4.0.1; what points of the rod's axis say, at its own places, decides."""
    tool = tabletop.tool("scaffold")
    assert tool is not None
    home = np.array(tabletop.home_joints)
    x, y, z = forward_kinematics(tabletop, tool, home)[:3, 3].tolist()
    around = Scene((), (Block("box", Box((x, y, z), (0.08, 0.08, 0.08))),))
    aside = Scene((), (Block("box", Box((x, y + 0.3, z), (0.08, 0.08, 0.08))),))
    for scene, through in ((around, True), (aside, False)):
        obstacles = pack_scene(scene, body_reach_m(tabletop, tool, 0.05))
        scratch = scratch_of(tabletop, tool.name)
        assert touches(arm_body(tabletop, tool), obstacles, 0.0, home, scratch) == through
        assert MujocoArm(tabletop, tool, scene).runs_through_a_box(home) == through


@pytest.mark.parametrize("name", ["twigs", "points", "many twigs"])
def test_depths_are_those_of_mujoco(tabletop: Robot, name: str) -> None:
    mounted = tabletop.tools[0]
    second = MujocoArm(tabletop, mounted, SCENES[name])
    body, scratch = arm_body(tabletop, mounted), scratch_of(tabletop, mounted.name)
    obstacles = pack_scene(SCENES[name], body_reach_m(tabletop, mounted, 0.05))
    compared = 0
    for q in postures(tabletop, 7, 600):
        depth, _, _ = nearest(body, obstacles, 0.0, q, scratch)
        if depth < -MUJOCO_M:
            assert depth == pytest.approx(second.distance(q), abs=1e-9)
            compared += 1
    assert compared > 20


def sampled(capsule: Capsule, pose: Array, count: int) -> Array:
    """Points of a capsule's axis in the base frame, shape (count, 3) [m]."""
    start, end = np.array(capsule.start_m), np.array(capsule.end_m)
    along = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
    return np.asarray(along @ pose[:3, :3].T + pose[:3, 3])


def test_the_nearest_pair_is_that_of_points_along_both(tabletop: Robot) -> None:
    tool = tabletop.tools[0]
    body, scratch = arm_body(tabletop, tool), scratch_of(tabletop, tool.name)
    scene = Scene(twigs(8, 6))
    obstacles = pack_scene(scene, body_reach_m(tabletop, tool, 0.05))
    for q in postures(tabletop, 9, 25):
        frames = link_transforms(tabletop, tool, q)
        back = np.eye(4)
        back[2, 3] = -tool.length_m
        owners = [*range(1, 7), "tool"]
        poses = [*frames[1:6], frames[6] @ back, frames[6]]
        shapes = [*(joint.body for joint in tabletop.joints), tool.body]
        best = (math.inf, None, "")
        for pose, own, owner in zip(poses, shapes, owners, strict=True):
            for one in own:
                places = sampled(one, pose, 120)
                for chain in scene.chains:
                    for piece in chain.capsules():
                        other = sampled(piece, np.eye(4), 120)
                        apart = np.linalg.norm(places[:, None] - other, axis=2).min()
                        best = min(best, (apart - one.radius_m - piece.radius_m, owner, chain.id))
        names = [own for own, has in zip(owners, shapes, strict=True) for _ in has]
        distance, shape, obstacle = nearest(body, obstacles, 1.0, q, scratch)
        # Points on both lie some millimetre apart, and so near the nearest they do not lose more.
        assert best[0] - 1.5e-3 < distance <= best[0] + 1e-12
        if distance > -0.005:
            assert (names[shape], scene.ids[obstacle]) == best[1:]


@pytest.mark.parametrize("name", ["points", "many twigs"])
def test_the_grid_finds_what_looking_at_each_finds(
    tabletop: Robot, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    tool = tabletop.tools[0]
    body, scratch, reach = (
        arm_body(tabletop, tool),
        scratch_of(tabletop),
        body_reach_m(tabletop, tool, 0.05),
    )
    monkeypatch.setattr("solver.scene.packing.DIRECT_CAPSULES", 10_000)
    direct = pack_scene(SCENES[name], reach)
    monkeypatch.setattr("solver.scene.packing.DIRECT_CAPSULES", 0)
    gridded = pack_scene(SCENES[name], reach)
    assert len(direct.gridded) == len(gridded.capsules) == 0
    for q in postures(tabletop, 10, 300):
        for most in (0.05, 0.002):
            assert nearest(body, gridded, most, q, scratch) == nearest(
                body, direct, most, q, scratch
            )
        assert touches(body, gridded, 0.005, q, scratch) == touches(body, direct, 0.005, q, scratch)


def test_what_a_stretched_arm_all_but_meets_is_not_left_out(tabletop: Robot) -> None:
    """Points beyond what the tool centre point may ever reach, and yet beside the arm's shapes."""
    tool = tabletop.tools[1]
    body, scratch = arm_body(tabletop, tool), scratch_of(tabletop, tool.name)
    rng, looked = np.random.default_rng(12), 0
    for q in postures(tabletop, 13, 40):
        tip = forward_kinematics(tabletop, tool, q)[:3, 3]
        further = tip * (tabletop.reach_m(tool) + 0.001) / np.linalg.norm(tip)
        points = further + rng.uniform(0.0, 0.002, (500, 1)) * further
        obstacles = pack_scene(
            Scene((), (), (), (Points("points", points, 0.001),)),
            body_reach_m(tabletop, tool, 0.2),
        )
        assert len(obstacles.gridded) == 500
        distance, shape, _ = nearest(body, obstacles, 0.2, q, scratch)
        if float(np.linalg.norm(further - tip)) < 0.2:
            assert shape != NOBODY
            assert distance < np.linalg.norm(further - tip)
            looked += 1
    assert looked > 10


@pytest.mark.parametrize("name", SCENES)
def test_a_clearance_is_what_it_is_told_to_be(tabletop: Robot, name: str) -> None:
    tool = tabletop.tools[0]
    body, scratch = arm_body(tabletop, tool), scratch_of(tabletop)
    obstacles = pack_scene(SCENES[name], body_reach_m(tabletop, tool, 0.05))
    free = 0
    for q in postures(tabletop, 11, 100):
        distance, shape, obstacle = nearest(body, obstacles, 0.05, q, scratch)
        if shape == NOBODY:
            assert distance == 0.05
            assert obstacle == NOBODY
            continue
        assert not touches(body, obstacles, distance - 1e-9, q, scratch)
        assert touches(body, obstacles, distance + 1e-9, q, scratch)
        free += distance > 0.0
    assert free > 3


def test_soft_obstacles_are_packed_apart(tabletop: Robot) -> None:
    tool = tabletop.tools[0]
    around = ((0.2, -0.5, 0.2), (0.2, 0.5, 0.2))
    scene = Scene(
        (Chain("hard", around, 0.01), Chain("leaf", around, 0.02, soft=True)),
        (Block("bush", Box((0.2, 0.0, 0.2), (0.1, 0.1, 0.1)), soft=True),),
        (Plane("wall", (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)),),
        (Points("seen", np.array([[0.2, 0.0, 0.3]]), 0.01, soft=True),),
    )
    hard = pack_scene(scene, body_reach_m(tabletop, tool, 0.05))
    soft = pack_scene(scene, body_reach_m(tabletop, tool, 0.05), soft=True)
    assert [scene.ids[k] for k in hard.of_capsules] == ["hard"]
    assert [scene.ids[k] for k in hard.of_planes] == ["wall"]
    assert not len(hard.of_boxes)
    assert [scene.ids[k] for k in soft.of_capsules] == ["leaf", "seen"]
    assert [scene.ids[k] for k in soft.of_boxes] == ["bush"]
    assert not len(soft.of_planes)


def test_home_is_clear_of_the_arm_and_the_table(tabletop: Robot) -> None:
    for tool in tabletop.tools:
        body, scratch = arm_body(tabletop, tool), scratch_of(tabletop, tool.name)
        home = np.array(tabletop.home_joints)
        assert nearest_of_itself(body, 0.005, home, scratch) == (0.005, NOBODY, NOBODY)


def test_an_arm_bent_into_the_table_tells_which_link(tabletop: Robot) -> None:
    tool = tabletop.tools[0]
    body, scratch = arm_body(tabletop, tool), scratch_of(tabletop, tool.name)
    q = np.array([0.0, math.radians(-40), 0.0, 0.0, 0.0, 0.0])
    distance, shape, other = nearest_of_itself(body, 0.0, q, scratch)
    assert distance < 0.0
    # Past the arm's own shapes and the fixed capsule of the base comes the table's box.
    assert other == len(body.links) + 1
    lowest = forward_heights(tabletop, q)
    assert body.links[shape] == 1 + int(np.argmin(lowest))


def forward_heights(robot: Robot, q: Array) -> Array:
    """Lowest point of each link's capsules [m]."""
    tool = robot.tools[0]
    frames = link_transforms(robot, tool, q)
    back = np.eye(4)
    back[2, 3] = -tool.length_m
    heights = []
    for k, joint in enumerate(robot.joints, start=1):
        pose = frames[k] @ (back if k == len(robot.joints) else np.eye(4))
        own = [sampled(one, pose, 9)[:, 2].min() - one.radius_m for one in joint.body]
        if k == len(robot.joints):
            own += [sampled(one, frames[k], 9)[:, 2].min() - one.radius_m for one in tool.body]
        heights.append(min(own))
    return np.array(heights)
