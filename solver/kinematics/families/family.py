"""What a family of arms tells: whose it is, and which inverse its arms have."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

from solver.robots.model import Array, Robot, Tool


@dataclass(frozen=True)
class Rail:
    """An arm on a slide: the first joint, and the robot that the others make.

    Attributes:
        axis: unit direction in which the first joint slides, in the base frame, three numbers.
        arm: the others, mounted where the slide stands at 0.
    """

    axis: tuple[float, float, float]
    arm: Robot

    def arm_at(self, position_m: float) -> Robot:
        """The arm with the slide at a position [m]."""
        x, y, z = (
            place + position_m * along
            for place, along in zip(self.arm.mount_position_m, self.axis, strict=True)
        )
        return replace(self.arm, mount_position_m=(x, y, z))


class Standing(NamedTuple):
    """The arm that has the closed form, as it stands in a posture of the whole robot.

    Attributes:
        arm: alone, mounted where it stands.
        first: the robot's joint from which on joints are the arm's.
    """

    arm: Robot
    first: int


@dataclass(frozen=True)
class Family:
    """A family of arms.

    Attributes:
        name: on the wire.
        summary: a line for people: which inverse, and so which methods.
        takes: whether an arm with a tool is one of the family.
        has_closed_form: the arm itself has one (`solver.kinematics.spherical_wrist`), and with it
            arcs, certificates, margins, relaxations, batches as one, and the choice of an order.
        rail: the slide under an arm that has the closed form; None for arms without such a slide.
            Without closed form and rail there is the numerical inverse.
    """

    name: str
    summary: str
    takes: Callable[[Robot, Tool], bool]
    has_closed_form: bool = False
    rail: Callable[[Robot], Rail | None] | None = None

    def rail_of(self, robot: Robot) -> Rail | None:
        """The slide that an arm of the family stands on, if it is one of those."""
        return None if self.rail is None else self.rail(robot)

    @property
    def has_branches(self) -> bool:
        """Whether postures have branch numbers: with a closed form, on a rail or not."""
        return self.has_closed_form or self.rail is not None

    def standing(self, robot: Robot, posture: Array) -> Standing | None:
        """The arm with the closed form in a posture, shape (joints,); None where there is none."""
        if self.has_closed_form:
            return Standing(robot, 0)
        rail = self.rail_of(robot)
        return None if rail is None else Standing(rail.arm_at(float(posture[0])), 1)
