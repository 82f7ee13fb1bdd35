"""The robot model: one TOML file a robot, read into frozen dataclasses.

Classic (standard) Denavit-Hartenberg convention: the transform of link i is
Rot_z(theta_i) Trans_z(d_i) Trans_x(a_i) Rot_x(alpha_i) (T equation 1). A revolute joint turns,
theta = q + offset; a prismatic joint slides along the same z axis, d = q + d_m, theta = offset.
Joint vectors are radians for revolute and metres for prismatic joints.
"""

import hashlib
import math
import os
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import cached_property, lru_cache
from importlib import resources
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from solver.exceptions import InvalidRobot, UnknownRobot
from solver.robots.rigid import transform

Array = NDArray[np.float64]

REVOLUTE: Final = "revolute"
PRISMATIC: Final = "prismatic"

ROBOTS_VARIABLE: Final = "PRUNUS_ROBOTS_DIR"
"""Environment variable that names a folder of further model files."""

# Fields whose unit depends on the joint's kind, and the ending of their key in a model file.
_ENDINGS: Final[Mapping[str, Mapping[str, str]]] = {
    REVOLUTE: {"lower": "_rad", "upper": "_rad", "velocity": "_rad_s", "acceleration": "_rad_s2"},
    PRISMATIC: {"lower": "_m", "upper": "_m", "velocity": "_m_s", "acceleration": "_m_s2"},
}
_DRIVE_KEYS: Final = {REVOLUTE: "drive_inertia_kg_m2", PRISMATIC: "drive_mass_kg"}


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

    @property
    def unit(self) -> str:
        """Unit of its position, rad or m."""
        return "rad" if self.kind == REVOLUTE else "m"


@dataclass(frozen=True)
class Tool:
    """An end-effector: it moves the tool centre point `length_m` along the last z axis.

    `mass_kg` counts half-way along that length.
    """

    name: str
    length_m: float
    description: str
    mass_kg: float = 0.0


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


def robot_names() -> tuple[str, ...]:
    """Names of the robots that ship and of those in the folder PRUNUS_ROBOTS_DIR, sorted."""
    return tuple(sorted(_model_files()))


def load_robot(name: str | Path) -> Robot:
    """The robot of that name, or the one in the model file at that path.

    Raises:
        UnknownRobot: no model file has that name.
        InvalidRobot: the file cannot be read or makes no sense.
    """
    if isinstance(name, Path):
        return parse_robot(name.read_bytes())
    files = _model_files()
    if name not in files:
        raise UnknownRobot(name, known=tuple(sorted(files)))
    robot = parse_robot(files[name].read_bytes())
    if robot.name != name:
        raise InvalidRobot(f"{name}.toml: the robot in it is named {robot.name!r}")
    return robot


def _model_files() -> dict[str, Path]:
    shipped = Path(str(resources.files("solver.robots")))
    folders = [shipped]
    if own := os.environ.get(ROBOTS_VARIABLE):
        folders.append(Path(own))
    files: dict[str, Path] = {}
    for folder in folders:
        if not folder.is_dir():
            raise InvalidRobot(f"{ROBOTS_VARIABLE} names no folder")
        for file in sorted(folder.glob("*.toml")):
            if file.stem in files:
                raise InvalidRobot(f"{file.stem}: a robot of this name ships; take another name")
            files[file.stem] = file
    return files


@lru_cache(maxsize=64)
def parse_robot(document: bytes) -> Robot:
    """A robot from the bytes of a model file; the same bytes are parsed once.

    Raises:
        InvalidRobot: not TOML, fields missing or unknown, or values that make no sense.
    """
    try:
        data = tomllib.loads(document.decode())
        mount = data.pop("mount_position_m", (0.0, 0.0, 0.0))
        in_degrees = [math.radians(value) for value in data.pop("mount_rpy_deg", (0.0, 0.0, 0.0))]
        turn = data.pop("mount_rpy_rad", in_degrees)
        roll = data.pop("flange_roll_rad", math.radians(data.pop("flange_roll_deg", 0.0)))
        robot = Robot(
            joints=tuple(_joint(entry) for entry in data.pop("joints")),
            tools=tuple(Tool(**entry) for entry in data.pop("tools")),
            home_joints=_numbers(data.pop("home_joints")),
            version=hashlib.sha256(document).hexdigest()[:12],
            mount_position_m=_three(mount),
            mount_rpy_rad=_three(turn),
            flange_roll_rad=float(roll),
            **data,
        )
        check_robot(robot)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise InvalidRobot(f"the model file cannot be read: {error}") from error
    return robot


def _joint(entry: Mapping[str, Any]) -> Joint:
    values: dict[str, Any] = {}
    kind = entry.get("kind", REVOLUTE)
    if kind not in _ENDINGS:
        raise ValueError(f"joint {entry.get('name')}: kind {kind!r} is none of {list(_ENDINGS)}")
    by_key = {f"{field}{ending}": field for field, ending in _ENDINGS[kind].items()}
    for key, value in entry.items():
        in_degrees = key.endswith("_deg")
        name = f"{key.removesuffix('_deg')}_rad" if in_degrees else key
        number = math.radians(value) if in_degrees else value
        values[by_key.get(name, name)] = number
    required = {field.name for field in fields(Joint) if field.default is MISSING}
    keys = {field: key for key, field in by_key.items()}
    missing = sorted(keys.get(field, field) for field in required - values.keys())
    if missing:
        raise KeyError(f"joint {entry.get('name')}: {', '.join(missing)}")
    if "link" in values:
        values["link"] = _link(values["link"], kind)
    return Joint(**values)


def _link(entry: Mapping[str, Any], kind: str) -> Link:
    values = dict(entry)
    drive = float(values.pop(_DRIVE_KEYS[kind], 0.0))
    centre = _three(values.pop("centre_m"))
    xx, yy, zz, xy, xz, yz = _numbers(values.pop("inertia_kg_m2"))
    return Link(
        centre_m=centre, inertia_kg_m2=(xx, yy, zz, xy, xz, yz), drive_inertia=drive, **values
    )


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


def _numbers(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _three(values: Any) -> tuple[float, float, float]:
    x, y, z = _numbers(values)
    return x, y, z


def _read_only(values: Any) -> Array:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array
