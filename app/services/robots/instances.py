"""Robots by name, and the refusals where there is none, or none that is connected."""

from app.services.exceptions import NotFound, Unavailable
from hardware.servos.instances import RobotInstance, load_instance
from solver import UnknownRobot


def robot_instance(name: str) -> RobotInstance:
    """The robot of that name.

    Raises:
        NotFound: there is none.
    """
    try:
        return load_instance(name)
    except UnknownRobot:
        raise NotFound("not_found", "There is no robot of this name.") from None


def no_worker(consequence: str) -> Unavailable:
    """The refusal for a robot without a worker."""
    return Unavailable("no_worker", f"No worker is connected. {consequence}")
