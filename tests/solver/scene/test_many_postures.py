"""Many postures at once are each what one is."""

import numpy as np

from bench.scenes import mixed, postures
from solver import Robot
from solver.scene.arm_body import arm_body, body_reach_m, shape_names
from solver.scene.clearance import body_scratch, nearest, touches
from solver.scene.many_postures import nearest_pairs, touching
from solver.scene.packing import pack_scene


def test_each_is_what_it_is_alone(tabletop: Robot) -> None:
    tool, scene = tabletop.tools[1], mixed(31)
    body, obstacles = (
        arm_body(tabletop, tool),
        pack_scene(scene, body_reach_m(tabletop, tool, 0.05)),
    )
    drawn = postures(tabletop, 32, 60)
    pairs, scratch = nearest_pairs(body, obstacles, 0.05, drawn), body_scratch(body)
    found = touching(body, obstacles, 0.005, drawn)
    for k, q in enumerate(drawn):
        assert found[k] == touches(body, obstacles, 0.005, q, scratch)
        alone = nearest(body, obstacles, 0.05, q, scratch)
        assert alone == (pairs.distances_m[k], pairs.shapes[k], pairs.obstacles[k])
    assert found.any()
    assert not found.all()
    assert (found == (pairs.distances_m < 0.005)).all()


def test_shapes_are_named_by_their_links(tabletop: Robot) -> None:
    laser, scaffold = tabletop.tools
    names = shape_names(tabletop, scaffold)
    body = arm_body(tabletop, scaffold)
    assert len(names) == len(body.links) == len(body.forks)
    assert names[:3] == ("joint_1", "joint_2", "joint_2")
    assert names[-3:] == ("tool",) * 3
    assert body.forks.tolist() == [False] * (len(names) - 2) + [True, True]
    assert "tool" in shape_names(tabletop, laser)
    assert [names[k] for k in np.flatnonzero(body.links == 2)] == ["joint_2"] * 2
