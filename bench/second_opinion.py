"""The arm's body among obstacles in MuJoCo: an independent opinion on what touches.

Nothing of `solver.scene` is used but the shapes: links are nested bodies made from the model's
Denavit-Hartenberg rows, and MuJoCo's own kinematics and collisions do the rest.
"""

import math
from collections.abc import Iterator, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from solver.robots.model import Robot, Tool
from solver.robots.shapes import Box, Capsule
from solver.scene.obstacles import Scene

Array = NDArray[np.float64]

AXIS_POINTS = 400
"""So many points of an axis are looked at, some tenth of a millimetre apart."""

_ARM, _WORLD = 'contype="1" conaffinity="0"', 'contype="0" conaffinity="1"'
"""Only the arm and the world are looked at together."""


class MujocoArm:
    """An arm with a tool, without gravity and time: where it is at a posture, and what it touches.

    Args:
        robot: with a body, revolute joints only.
        tool: one of its tools.
        scene: hard obstacles.
    """

    def __init__(self, robot: Robot, tool: Tool, scene: Scene) -> None:
        text = "\n".join(_document(robot, tool, scene))
        self._model = mujoco.MjModel.from_xml_string(text)
        self._data = mujoco.MjData(self._model)
        shapes = sum(len(joint.body) for joint in robot.joints) + len(tool.body)
        shapes += 0 if tool.forks is None else len(list(tool.forks.capsules()))
        assert self._model.ngeom == shapes + len(list(_obstacles(scene))), "none is dropped"

    def distance(self, q: Sequence[float] | Array) -> float:
        """The deepest contact at a posture, below zero [m]; infinity where nothing touches."""
        self._data.qpos[:] = q
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)
        return float(self._data.contact.dist.min()) if self._data.ncon else math.inf

    def runs_through_a_box(self, q: Sequence[float] | Array) -> bool:
        """Whether a capsule's axis has a point inside a box, where MuJoCo's own places say it is.

        MuJoCo 4.0.1 sees no contact of a thin capsule whose axis runs through a box.
        """
        self._data.qpos[:] = q
        mujoco.mj_kinematics(self._model, self._data)
        model, places, turns = self._model, self._data.geom_xpos, self._data.geom_xmat
        kinds = model.geom_type
        boxes = np.flatnonzero(kinds == mujoco.mjtGeom.mjGEOM_BOX)
        for k in np.flatnonzero(
            (kinds == mujoco.mjtGeom.mjGEOM_CAPSULE) & (model.geom_contype > 0)
        ):
            along = turns[k].reshape(3, 3)[:, 2] * model.geom_size[k, 1]
            axis = places[k] + np.linspace(-1.0, 1.0, AXIS_POINTS)[:, None] * along
            for box in boxes:
                seen = (axis - places[box]) @ turns[box].reshape(3, 3)
                if (np.abs(seen) < model.geom_size[box]).all(axis=1).any():
                    return True
        return False


def _document(robot: Robot, tool: Tool, scene: Scene) -> Iterator[str]:
    yield '<mujoco><compiler angle="radian"/><worldbody>'
    yield from _obstacles(scene)
    yield f'<body pos="{_text(robot.mount_position_m)}" quat="{_text(_quaternion(robot.mount))}">'
    for joint in robot.joints:
        half = joint.offset_rad / 2
        turn = (math.cos(half), 0.0, 0.0, math.sin(half))
        yield f'<body quat="{_text(turn)}"><joint type="hinge" axis="0 0 1"/>'
        yield '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        tilt = (math.cos(joint.alpha_rad / 2), math.sin(joint.alpha_rad / 2), 0.0, 0.0)
        yield f'<body pos="{_text((joint.a_m, 0.0, joint.d_m))}" quat="{_text(tilt)}">'
        yield from (_capsule(shape, _ARM) for shape in joint.body)
    half = robot.flange_roll_rad / 2
    roll = (math.cos(half), 0.0, 0.0, math.sin(half))
    yield f'<body pos="0 0 {tool.length_m!r}" quat="{_text(roll)}">'
    forks = [] if tool.forks is None else list(tool.forks.capsules())
    yield from (_capsule(shape, _ARM) for shape in (*tool.body, *forks))
    yield "</body>" + "</body></body>" * len(robot.joints) + "</body></worldbody></mujoco>"


def _obstacles(scene: Scene) -> Iterator[str]:
    for chain in scene.chains:
        yield from (_capsule(shape, _WORLD) for shape in chain.capsules())
    yield from (_box(block.box) for block in scene.blocks)
    for plane in scene.planes:
        x, y, z = np.array(plane.normal) / np.linalg.norm(plane.normal)
        # The turn that takes the z axis there.
        turn = (1.0 + z, -y, x, 0.0) if z > -1.0 else (0.0, 1.0, 0.0, 0.0)
        place = _text(plane.position_m)
        yield f'<geom type="plane" size="9 9 1" pos="{place}" quat="{_text(turn)}" {_WORLD}/>'
    for cloud in scene.points:
        for point in cloud.points_m.tolist():
            yield f'<geom type="sphere" size="{cloud.radius_m!r}" pos="{_text(point)}" {_WORLD}/>'


def _capsule(shape: Capsule, kind: str) -> str:
    if shape.start_m == shape.end_m:
        place = _text(shape.start_m)
        return f'<geom type="sphere" size="{shape.radius_m!r}" pos="{place}" {kind}/>'
    ends = _text((*shape.start_m, *shape.end_m))
    return f'<geom type="capsule" size="{shape.radius_m!r}" fromto="{ends}" {kind}/>'


def _box(box: Box) -> str:
    half = _text([size / 2 for size in box.size_m])
    x, y, z, w = box.quaternion_xyzw
    turn, place = _text((w, x, y, z)), _text(box.position_m)
    return f'<geom type="box" size="{half}" pos="{place}" quat="{turn}" {_WORLD}/>'


def _quaternion(pose: Array) -> Array:
    found = np.empty(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(pose[:3, :3]).ravel())
    return found


def _text(values: Sequence[float] | Array) -> str:
    return " ".join(repr(float(value)) for value in values)
