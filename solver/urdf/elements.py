"""The joints of a URDF file, and the numbers in it."""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import Final

import numpy as np
from defusedxml import ElementTree as SafeTree
from defusedxml.common import DefusedXmlException

from solver.exceptions import InvalidRobot
from solver.robots.model import PRISMATIC, REVOLUTE, Array
from solver.robots.rigid import transform
from solver.urdf.tolerances import URDF_DIGIT_SHARE, URDF_DIGITS

MOVING: Final = {"revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC}


@dataclass(frozen=True)
class Element:
    """A joint of the file: its frame in the parent link at q = 0, and in itself the axis."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Array
    axis: Array
    element: ET.Element


def parsed(document: bytes) -> ET.Element:
    """The document's root; document types and entities are refused."""
    try:
        root = SafeTree.fromstring(document, forbid_dtd=True)
    except (ET.ParseError, DefusedXmlException, ValueError, LookupError) as error:
        raise InvalidRobot(f"the URDF cannot be read: {error!r}") from error
    if root.tag != "robot":
        raise InvalidRobot("the document's root element is not <robot>")
    return root


def joint_elements(root: ET.Element) -> list[Element]:
    """Every joint of the file."""
    elements = []
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise InvalidRobot(f"joint {name!r} has no parent or no child")
        axis_element = joint.find("axis")
        axis = np.array([1.0, 0.0, 0.0])  # URDF's default
        if axis_element is not None:
            axis = _vector(axis_element.get("xyz", "1 0 0"), name)
        kind = joint.get("type", "")
        if kind in MOVING and not np.linalg.norm(axis) > 0:
            raise InvalidRobot(f"joint {name!r} has an axis without a direction")
        origin = origin_of(joint.find("origin"), name)
        elements.append(
            Element(name, kind, parent.get("link", ""), child.get("link", ""), origin, axis, joint)
        )
    return elements


def serial_chain(elements: list[Element], base: str, tip: str) -> list[Element]:
    """The joints from one link to another, in this order."""
    by_child = {entry.child: entry for entry in elements}
    chain: list[Element] = []
    link = tip
    while link != base:
        if link not in by_child or len(chain) > len(elements):
            raise InvalidRobot(f"no chain of joints leads from link {base!r} to link {tip!r}")
        chain.append(by_child[link])
        link = chain[-1].parent
    for entry in chain:
        if entry.kind not in MOVING and entry.kind != "fixed":
            raise InvalidRobot(f"joint {entry.name!r} is {entry.kind!r}, which no serial arm has")
        if entry.element.find("mimic") is not None:
            raise InvalidRobot(f"joint {entry.name!r} mimics another")
    return chain[::-1]


def origin_of(element: ET.Element | None, where: str) -> Array:
    """The transform of an <origin>, shape (4, 4) [m]."""
    if element is None:
        return np.eye(4)
    position = _vector(element.get("xyz", "0 0 0"), where)
    angles = element.get("rpy", "0 0 0").split()
    if len(angles) != 3:
        raise InvalidRobot(f"{where!r} has an rpy that is not three numbers")
    return transform(position, [_angle(text, where) for text in angles])


def _vector(text: str, where: str) -> Array:
    numbers = [number_in(part, where) for part in text.split()]
    if len(numbers) != 3:
        raise InvalidRobot(f"{where!r} has a vector that is not three numbers")
    return np.array(numbers)


def _angle(text: str, where: str) -> float:
    """The number, or the multiple of 15 degrees that it is a rounding of, to the digits written."""
    value = number_in(text, where)
    multiple = round(value / (math.pi / 12)) * math.pi / 12
    digits = len(text.lower().partition("e")[0].partition(".")[2])
    plain = "e" not in text.lower() and digits >= URDF_DIGITS
    return (
        multiple if plain and abs(value - multiple) <= URDF_DIGIT_SHARE * 10.0**-digits else value
    )


def number_in(text: str, where: str) -> float:
    """The number in a text that stands at a named place."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRobot(f"{where!r} has {text[:40]!r} where a number is due")
    return value
