"""Robots by the names under which requests and workers know them.

Each model is a robot of the same name, those in the folder PRUNUS_ROBOTS_DIR too; one with an arm
file has a simulated twin as well, named with "-sim", on which a plan can be watched before the arm
moves.
"""

from dataclasses import dataclass, replace
from typing import Final

from hardware.servos.joints import arm_names
from solver import InvalidRobot, Robot, UnknownRobot, load_robot, robot_names

SIMULATED_SUFFIX: Final = "-sim"


@dataclass(frozen=True)
class RobotInstance:
    """A robot that can be planned for and joined by a worker.

    Attributes:
        robot: the model, under the instance's name.
        model: the model's name.
        simulated: only simulated servos may stand behind it.
    """

    robot: Robot
    model: str
    simulated: bool

    @property
    def name(self) -> str:
        """The instance's name."""
        return self.robot.name


def instance_names() -> tuple[str, ...]:
    """Every robot's name, sorted.

    Raises:
        InvalidRobot: a model has the name of another's simulated twin.
    """
    models = robot_names()
    twins = [f"{name}{SIMULATED_SUFFIX}" for name in arm_names()]
    for name in twins:
        if name in models:
            raise InvalidRobot(f"{name}: this is the name of a simulated twin")
    return tuple(sorted((*models, *twins)))


def load_instance(name: str) -> RobotInstance:
    """The robot of that name.

    Raises:
        UnknownRobot: there is none.
    """
    if name not in instance_names():
        raise UnknownRobot(name, known=instance_names())
    simulated = name not in robot_names()
    model = name.removesuffix(SIMULATED_SUFFIX) if simulated else name
    robot = load_robot(model)
    return RobotInstance(replace(robot, name=name) if simulated else robot, model, simulated)
