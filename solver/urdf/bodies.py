"""What the joints of a URDF file carry."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from solver.exceptions import InvalidRobot
from solver.kinematics.dynamics import link_tensor, shift_tensor, tensor_entries
from solver.robots.model import Array, Link
from solver.robots.rigid import inverse
from solver.urdf.elements import MOVING, Element, number_in, origin_of


@dataclass(frozen=True)
class Body:
    """Mass [kg], centre [m] and inertia about it [kg m2] in the base frame at q = 0."""

    mass_kg: float
    centre: Array
    inertia: Array


def link_of(body: Body, frame: Array) -> Link:
    """A body of the base frame at q = 0, in the frame of its row."""
    back = inverse(frame)
    x, y, z = (float(value) for value in back[:3, :3] @ body.centre + back[:3, 3])
    tensor = back[:3, :3] @ body.inertia @ back[:3, :3].T
    return Link(body.mass_kg, (x, y, z), tensor_entries(tensor))


def carried_bodies(
    root: ET.Element, elements: list[Element], chain: list[Element]
) -> list[Body | None]:
    """What each moving joint carries up to the next, in the base frame at q = 0."""
    inertials = {link.get("name", ""): link.find("inertial") for link in root.findall("link")}
    on_chain = {entry.child for entry in chain}
    groups: list[list[Body]] = []
    pose = np.eye(4)
    for entry in chain:
        pose = pose @ entry.origin
        if entry.kind in MOVING:
            groups.append([])
        if groups:
            for link, place in _rigid(elements, entry.child, pose, on_chain):
                element = inertials.get(link)
                if element is not None:
                    groups[-1].append(_body(element, place, link))
    return [_sum(group) if group else None for group in groups]


def _rigid(
    elements: list[Element], link: str, pose: Array, on_chain: set[str]
) -> Iterator[tuple[str, Array]]:
    """A link and what is fixed to it beside the chain, with their frames."""
    yield link, pose
    for entry in elements:
        if entry.parent == link and entry.kind == "fixed" and entry.child not in on_chain:
            yield from _rigid(elements, entry.child, pose @ entry.origin, on_chain)


def _body(inertial: ET.Element, place: Array, link: str) -> Body:
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        raise InvalidRobot(f"link {link!r} has an <inertial> without mass or inertia")
    pose = place @ origin_of(inertial.find("origin"), link)
    xx, yy, zz, xy, xz, yz = (
        number_in(inertia.get(key, "0"), link) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    tensor = link_tensor(Link(0.0, (0.0, 0.0, 0.0), (xx, yy, zz, xy, xz, yz)))
    turn = pose[:3, :3]
    return Body(number_in(mass.get("value", ""), link), pose[:3, 3], turn @ tensor @ turn.T)


def _sum(bodies: list[Body]) -> Body:
    total = sum(body.mass_kg for body in bodies)
    if total == 0.0:
        return replace(bodies[0], inertia=np.sum([body.inertia for body in bodies], axis=0))
    centre = np.sum([body.mass_kg * body.centre for body in bodies], axis=0) / total
    inertia = np.sum(
        [body.inertia + body.mass_kg * shift_tensor(body.centre - centre) for body in bodies],
        axis=0,
    )
    return Body(total, centre, inertia)
