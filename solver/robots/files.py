"""Model files: one TOML file a robot, read into `solver.robots.model`."""

import hashlib
import math
import os
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any, Final

from solver.exceptions import InvalidRobot, UnknownRobot
from solver.robots.model import PRISMATIC, REVOLUTE, Joint, Link, Robot, Tool, check_robot
from solver.robots.shapes import Box, Capsule, Fixture, Forks

ROBOTS_VARIABLE: Final = "PRUNUS_ROBOTS_DIR"
"""Environment variable that names a folder of further model files."""

# Fields whose unit depends on the joint's kind, and the ending of their key in a model file.
_ENDINGS: Final[Mapping[str, Mapping[str, str]]] = {
    REVOLUTE: {"lower": "_rad", "upper": "_rad", "velocity": "_rad_s", "acceleration": "_rad_s2"},
    PRISMATIC: {"lower": "_m", "upper": "_m", "velocity": "_m_s", "acceleration": "_m_s2"},
}
_DRIVE_KEYS: Final = {REVOLUTE: "drive_inertia_kg_m2", PRISMATIC: "drive_mass_kg"}


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
            tools=tuple(_tool(entry) for entry in data.pop("tools")),
            fixtures=tuple(_fixture(entry) for entry in data.pop("fixtures", ())),
            kept_apart=tuple(_two_names(pair) for pair in data.pop("kept_apart", ())),
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
    if "body" in values:
        values["body"] = _capsules(values["body"])
    if "link" in values:
        values["link"] = _link(values["link"], kind)
    return Joint(**values)


def _tool(entry: Mapping[str, Any]) -> Tool:
    values = {**entry, "body": _capsules(entry.get("body", ()))}
    if "forks" in values:
        values["forks"] = Forks(**values["forks"])
    return Tool(**values)


def _fixture(entry: Mapping[str, Any]) -> Fixture:
    values = {**entry, "capsules": _capsules(entry.get("capsules", ()))}
    values["boxes"] = tuple(_box(box) for box in entry.get("boxes", ()))
    return Fixture(**values)


def _capsules(entries: Iterable[Mapping[str, Any]]) -> tuple[Capsule, ...]:
    return tuple(
        Capsule(**{**entry, "start_m": _three(entry["start_m"]), "end_m": _three(entry["end_m"])})
        for entry in entries
    )


def _box(entry: Mapping[str, Any]) -> Box:
    values = {**entry, "position_m": _three(entry["position_m"]), "size_m": _three(entry["size_m"])}
    if "quaternion_xyzw" in values:
        x, y, z, w = _numbers(values["quaternion_xyzw"])
        values["quaternion_xyzw"] = (x, y, z, w)
    return Box(**values)


def _two_names(pair: Iterable[str]) -> tuple[str, str]:
    one, other = pair
    return one, other


def _link(entry: Mapping[str, Any], kind: str) -> Link:
    values = dict(entry)
    drive = float(values.pop(_DRIVE_KEYS[kind], 0.0))
    centre = _three(values.pop("centre_m"))
    xx, yy, zz, xy, xz, yz = _numbers(values.pop("inertia_kg_m2"))
    return Link(
        centre_m=centre, inertia_kg_m2=(xx, yy, zz, xy, xz, yz), drive_inertia=drive, **values
    )


def _numbers(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _three(values: Any) -> tuple[float, float, float]:
    x, y, z = _numbers(values)
    return x, y, z
