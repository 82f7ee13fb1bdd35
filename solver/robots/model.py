"""The robot model: frozen dataclasses; `solver.robots.files` reads them from files.

Classic (standard) Denavit-Hartenberg convention: the transform of link i is
Rot_z(theta_i) Trans_z(d_i) Trans_x(a_i) Rot_x(alpha_i) (T equation 1). A revolute joint turns,
theta = q + offset; a prismatic joint slides along the same z axis, d = q + d_m, theta = offset.
Joint vectors are radians for revolute and metres for prismatic joints.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from solver.exceptions import InvalidRobot
from solver.robots.rigid import transform
from solver.robots.shapes import Box, Capsule, Fixture, Forks

Array = NDArray[np.float64]

REVOLUTE: Final = "revolute"
PRISMATIC: Final = "prismatic"

TOOL: Final = "tool"
"""The tool's name among those of links in `Robot.kept_apart`, and where a collision is told."""


@dataclass(frozen=True)
class Link:
    """What the link behind a joint weighs; in a model file the table `[joints.link]`.

    Attributes:
        mass_kg: its mass [kg].
        centre_m: its centre of mass in the joint's Denavit-Hartenberg frame, the one that moves
            with the link [m].
        inertia_kg_m2: xx, yy, zz, xy, xz, yz about that centre, in that frame's directions.
        drive_inertia: of the motor's rotor, as felt at the joint: times the gear ratio squared
            [kg m2; kg for a prismatic joint].
    """

    mass_kg: float
    centre_m: tuple[float, float, float]
    inertia_kg_m2: tuple[float, float, float, float, float, float]
    drive_inertia: float = 0.0


@dataclass(frozen=True)
class Joint:
    """One joint and the link behind it: lengths in m, angles in rad.

    Attributes:
        lower: lower limit [rad, or m for a prismatic joint]; so `upper`.
        velocity: the most, a second; so `acceleration`, a second squared.
        kind: "revolute" or "prismatic".
        servo: what drives it, if it is a servo.
        link: masses, if they are known or estimated.
        body: shapes of the link, in the frame that moves with it.
    """

    name: str
    a_m: float
    alpha_rad: float
    d_m: float
    offset_rad: float
    lower: float
    upper: float
    velocity: float
    acceleration: float
    kind: str = REVOLUTE
    servo: str | None = None
    link: Link | None = None
    body: tuple[Capsule, ...] = ()

    @property
    def unit(self) -> str:
        """Unit of its position, rad or m."""
        return "rad" if self.kind == REVOLUTE else "m"


@dataclass(frozen=True)
class Tool:
    """An end-effector: it moves the tool centre point `length_m` along the last z axis.

    `mass_kg` counts half-way along that length.

    Attributes:
        body: its shapes but for the forks, in the tool's frame.
        forks: the two rods that reach about a branch.
    """

    name: str
    length_m: float
    description: str
    mass_kg: float = 0.0
    body: tuple[Capsule, ...] = ()
    forks: Forks | None = None


@dataclass(frozen=True)
class Robot:
    """A serial arm in the base frame. Hashable; the arrays are read-only views of it.

    Attributes:
        mount_position_m: where the first joint's frame stands in the base frame [m].
        mount_rpy_rad: how it is turned: about x, then y, then z of the base frame (as in URDF).
        flange_roll_rad: a last turn about the last z axis, where the tool's y axis is not that of
            the last row; the last link's frame is turned with it.
        home_joints: the default start posture [rad or m].
        version: a digest of the model file: a plan made with another model is not this robot's.
        mass_source: where the masses are from, and whether they are estimates.
        fixtures: what the arm stands on.
        kept_apart: pairs of joints' links, fixtures and "tool" that may not meet, by name.
        body_source: where the shapes are from, and whether they are estimates.
    """

    name: str
    description: str
    source: str
    joints: tuple[Joint, ...]
    tools: tuple[Tool, ...]
    default_tool: str
    home_joints: tuple[float, ...]
    version: str
    mount_position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mount_rpy_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    flange_roll_rad: float = 0.0
    mass_source: str = ""
    fixtures: tuple[Fixture, ...] = ()
    kept_apart: tuple[tuple[str, str], ...] = ()
    body_source: str = ""

    @cached_property
    def lower(self) -> Array:
        """Lower position limits, shape (n,) [rad or m]."""
        return _read_only([joint.lower for joint in self.joints])

    @cached_property
    def upper(self) -> Array:
        """Upper position limits, shape (n,) [rad or m]."""
        return _read_only([joint.upper for joint in self.joints])

    @cached_property
    def velocity(self) -> Array:
        """Velocity limits, shape (n,) [rad/s or m/s]."""
        return _read_only([joint.velocity for joint in self.joints])

    @cached_property
    def acceleration(self) -> Array:
        """Acceleration limits, shape (n,) [rad/s2 or m/s2]."""
        return _read_only([joint.acceleration for joint in self.joints])

    @cached_property
    def turning(self) -> Array:
        """1 for revolute, 0 for prismatic joints, shape (n,)."""
        return _read_only([float(joint.kind == REVOLUTE) for joint in self.joints])

    @cached_property
    def mount(self) -> Array:
        """The first joint's frame in the base frame, shape (4, 4) [m]."""
        return _read_only(transform(self.mount_position_m, self.mount_rpy_rad))

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names in the order of every joint vector."""
        return tuple(joint.name for joint in self.joints)

    @property
    def has_masses(self) -> bool:
        """Whether every link's mass is in the model."""
        return all(joint.link is not None for joint in self.joints)

    def tool(self, name: str) -> Tool | None:
        """The tool of that name, or None."""
        return next((tool for tool in self.tools if tool.name == name), None)

    def reach_m(self, tool: Tool) -> float:
        """Upper bound of the tool centre point's distance from the base origin [m]."""
        links = sum(math.hypot(joint.a_m, _longest(joint)) for joint in self.joints)
        return math.hypot(*self.mount_position_m) + links + abs(tool.length_m)

    def limits_within(self, margin_rad: float) -> tuple[Array, Array]:
        """Lower and upper limits, those of revolute joints drawn in by a margin, shape (n,) each.

        Prismatic joints keep theirs: an angle says nothing about metres.
        """
        inset = margin_rad * self.turning
        return np.asarray(self.lower + inset), np.asarray(self.upper - inset)

    def limit_margin(self, rows: Array) -> Array:
        """Smallest distance of a revolute joint to its limit, rows (..., n) to shape (...) [rad].

        Prismatic joints are left out: their distance is no angle.
        """
        turning = self.turning > 0
        inside = np.minimum(rows - self.lower, self.upper - rows)
        return np.asarray(inside[..., turning].min(axis=-1))


def check_robot(robot: Robot) -> None:
    """Raise InvalidRobot if the values of a model make no sense together."""
    count = len(robot.joints)
    if len(robot.home_joints) != count or not count:
        raise InvalidRobot(f"{robot.name}: home_joints needs {count} values, and an arm a joint")
    placed = (*robot.mount_position_m, *robot.mount_rpy_rad, robot.flange_roll_rad)
    if not all(math.isfinite(value) for value in placed):
        raise InvalidRobot(f"{robot.name}: mount or flange has a value that is not finite")
    if len(set(robot.joint_names)) != count:
        raise InvalidRobot(f"{robot.name}: two joints have one name")
    if robot.tool(robot.default_tool) is None:
        raise InvalidRobot(
            f"{robot.name}: default_tool {robot.default_tool!r} is not among its tools"
        )
    for tool in robot.tools:
        if not (math.isfinite(tool.length_m) and 0 <= tool.mass_kg < math.inf):
            raise InvalidRobot(f"{robot.name}: tool {tool.name} has no usable length or mass")
    for joint, home in zip(robot.joints, robot.home_joints, strict=True):
        _check_joint(f"{robot.name}: ", joint, home)
    _check_body(robot)


def _check_body(robot: Robot) -> None:
    fixtures = [fixture.name for fixture in robot.fixtures]
    names = [*robot.joint_names, TOOL, *fixtures]
    if len(set(names)) != len(names):
        raise InvalidRobot(f"{robot.name}: two of joints, fixtures and {TOOL!r} have one name")
    for pair in robot.kept_apart:
        if len(set(pair)) != 2 or not set(pair) <= set(names) or set(pair) <= set(fixtures):
            raise InvalidRobot(f"{robot.name}: kept_apart has {pair}, which are no two that move")
    shapes: dict[str, Sequence[Capsule | Box | Forks]] = {
        **{joint.name: joint.body for joint in robot.joints},
        **{fixture.name: (*fixture.capsules, *fixture.boxes) for fixture in robot.fixtures},
    }
    for tool in robot.tools:
        shapes[f"{TOOL} {tool.name}"] = (*tool.body, *([] if tool.forks is None else [tool.forks]))
    for name, own in shapes.items():
        if not all(shape.makes_sense for shape in own):
            raise InvalidRobot(f"{robot.name}: {name} has a shape without a size")


def _check_joint(prefix: str, joint: Joint, home: float) -> None:
    lengths = (joint.a_m, joint.alpha_rad, joint.d_m, joint.offset_rad, joint.lower, joint.upper)
    if not all(math.isfinite(value) for value in lengths):
        raise InvalidRobot(f"{prefix}{joint.name} has a value that is not finite")
    if not joint.lower < joint.upper:
        raise InvalidRobot(f"{prefix}{joint.name} has its limits out of order")
    if not joint.lower <= home <= joint.upper:
        raise InvalidRobot(f"{prefix}home is outside the limits of {joint.name}")
    if not 0 < min(joint.velocity, joint.acceleration) < math.inf:
        raise InvalidRobot(f"{prefix}{joint.name} needs speed limits above zero")
    if joint.link is not None and not (joint.link.mass_kg >= 0 and joint.link.drive_inertia >= 0):
        raise InvalidRobot(f"{prefix}{joint.name} has a mass below zero")


def _longest(joint: Joint) -> float:
    if joint.kind == REVOLUTE:
        return joint.d_m
    return max(abs(joint.d_m + joint.lower), abs(joint.d_m + joint.upper))


def _read_only(values: Any) -> Array:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array
