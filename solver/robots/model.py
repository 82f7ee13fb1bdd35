"""The robot model: one TOML file a robot, read into frozen dataclasses.

Classic (standard) Denavit-Hartenberg convention: the transform of link i is
Rot_z(q_i + offset_i) Trans_z(d_i) Trans_x(a_i) Rot_x(alpha_i) (T equation 1).
"""

import hashlib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.exceptions import InvalidRobot, UnknownRobot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Joint:
    """One revolute joint and the link behind it: lengths in m, angles in rad, speeds a second."""

    name: str
    servo: str
    a_m: float
    alpha_rad: float
    d_m: float
    offset_rad: float
    lower_rad: float
    upper_rad: float
    velocity_rad_s: float
    acceleration_rad_s2: float


@dataclass(frozen=True)
class Tool:
    """An end-effector: it moves the tool centre point `length_m` along the last z axis."""

    name: str
    length_m: float
    description: str


@dataclass(frozen=True)
class Robot:
    """A serial arm in the base frame (m, rad). Hashable; the arrays are read-only views of it.

    `version` is a digest of the model file: a plan made with another model is not this robot's.
    """

    name: str
    description: str
    source: str
    joints: tuple[Joint, ...]
    tools: tuple[Tool, ...]
    default_tool: str
    home_rad: tuple[float, ...]
    version: str

    @cached_property
    def lower(self) -> Array:
        """Lower position limits, shape (n,) [rad]."""
        return _read_only([joint.lower_rad for joint in self.joints])

    @cached_property
    def upper(self) -> Array:
        """Upper position limits, shape (n,) [rad]."""
        return _read_only([joint.upper_rad for joint in self.joints])

    @cached_property
    def velocity(self) -> Array:
        """Velocity limits, shape (n,) [rad/s]."""
        return _read_only([joint.velocity_rad_s for joint in self.joints])

    @cached_property
    def acceleration(self) -> Array:
        """Acceleration limits, shape (n,) [rad/s2]."""
        return _read_only([joint.acceleration_rad_s2 for joint in self.joints])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names in the order of every joint vector."""
        return tuple(joint.name for joint in self.joints)

    def tool(self, name: str) -> Tool | None:
        """The tool of that name, or None."""
        return next((tool for tool in self.tools if tool.name == name), None)

    def reach_m(self, tool: Tool) -> float:
        """Upper bound of the tool centre point's distance from the base origin [m]."""
        links = sum(math.hypot(joint.a_m, joint.d_m) for joint in self.joints)
        return links + abs(tool.length_m)


def robot_names() -> tuple[str, ...]:
    """Names of the robots that ship, sorted."""
    folder = resources.files("solver.robots")
    files = (Path(entry.name) for entry in folder.iterdir())
    return tuple(sorted(file.stem for file in files if file.suffix == ".toml"))


def load_robot(name: str) -> Robot:
    """The shipped robot of that name.

    Raises:
        UnknownRobot: no model file has that name.
    """
    if name not in robot_names():
        raise UnknownRobot(name, known=robot_names())
    return parse_robot((resources.files("solver.robots") / f"{name}.toml").read_bytes())


def parse_robot(document: bytes) -> Robot:
    """A robot from the bytes of a model file.

    Raises:
        InvalidRobot: not TOML, fields missing or unknown, or values that make no sense.
    """
    try:
        data = tomllib.loads(document.decode())
        joints = tuple(_joint(entry) for entry in data.pop("joints"))
        tools = tuple(Tool(**entry) for entry in data.pop("tools"))
        home = tuple(float(value) for value in data.pop("home_rad"))
        version = hashlib.sha256(document).hexdigest()[:12]
        robot = Robot(joints=joints, tools=tools, home_rad=home, version=version, **data)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise InvalidRobot(f"the model file cannot be read: {error}") from error
    _check(robot)
    return robot


def _joint(entry: Mapping[str, Any]) -> Joint:
    values: dict[str, Any] = {}
    for key, value in entry.items():
        in_degrees = key.endswith("_deg")
        name = f"{key.removesuffix('_deg')}_rad" if in_degrees else key
        values[name] = math.radians(value) if in_degrees else value
    missing = {field.name for field in fields(Joint)} - values.keys()
    if missing:
        raise KeyError(f"joint {entry.get('name')}: {', '.join(sorted(missing))}")
    return Joint(**values)


def _check(robot: Robot) -> None:
    if len(robot.home_rad) != len(robot.joints):
        raise InvalidRobot(f"{robot.name}: home_rad needs {len(robot.joints)} values")
    if robot.tool(robot.default_tool) is None:
        raise InvalidRobot(
            f"{robot.name}: default_tool {robot.default_tool!r} is not among its tools"
        )
    for joint, home in zip(robot.joints, robot.home_rad, strict=True):
        if not joint.lower_rad < joint.upper_rad:
            raise InvalidRobot(f"{robot.name}: {joint.name} has its limits out of order")
        if not joint.lower_rad <= home <= joint.upper_rad:
            raise InvalidRobot(f"{robot.name}: home is outside the limits of {joint.name}")
        if min(joint.velocity_rad_s, joint.acceleration_rad_s2) <= 0:
            raise InvalidRobot(f"{robot.name}: {joint.name} needs speed limits above zero")


def _read_only(values: list[float]) -> Array:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array
