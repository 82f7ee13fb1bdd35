"""What is asked: targets, options and the robot, frozen and checked as a whole.

Field names are those of the request's JSON, so that a fault points to the same place in both.
Lengths in metres, angles in radians, everything in the robot's base frame.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

from solver.exceptions import Fault, InvalidProblem
from solver.frames.transforms import NamedFrame
from solver.kinematics.families import has_closed_form
from solver.kinematics.torque_weights import torque_weights
from solver.problem.checks import problem_faults
from solver.problem.options import (
    DEFAULT_POSITION_MARGIN_M,
    FULL_ANSWER,
    FULL_ANSWER_TARGETS,
    Options,
)
from solver.problem.targets import Target
from solver.robots.model import Robot, Tool


@dataclass(frozen=True)
class Problem:
    """A batch of targets for one robot with one tool, from one start posture.

    `tool` and `start_joints` default to the robot's own. Targets are in the base frame; `frame`
    only tells in which other one they were sent, if in one (`targets_in_base`).
    Construction checks everything:

    Raises:
        InvalidProblem: with every fault found, each with the path of its field.
    """

    robot: Robot
    targets: Sequence[Target]
    tool: Tool | str | None = None
    start_joints: Sequence[float] | None = None
    options: Options = field(default_factory=Options)
    frame: NamedFrame | None = None

    def __post_init__(self) -> None:
        faults: list[Fault] = []
        tool = self._resolve_tool(faults)
        object.__setattr__(self, "targets", tuple(self.targets))
        start = self.robot.home_joints if self.start_joints is None else self.start_joints
        faults += problem_faults(self.robot, tool, self.targets, start, self.options)
        if faults:
            raise InvalidProblem(tuple(faults))
        object.__setattr__(self, "tool", tool)
        object.__setattr__(self, "start_joints", tuple(float(value) for value in start))
        object.__setattr__(self, "options", _resolved(self.options, self))

    def _resolve_tool(self, faults: list[Fault]) -> Tool:
        default = self.robot.tool(self.robot.default_tool)
        assert default is not None, "parse_robot checks it"
        if self.tool is None:
            return default
        if isinstance(self.tool, Tool):
            return self.tool
        tool = self.robot.tool(self.tool)
        if tool is None:
            known = ", ".join(tool.name for tool in self.robot.tools)
            faults.append(Fault(("tool",), f"unknown tool; known: {known}"))
        return tool or default

    @cached_property
    def targets_by_id(self) -> Mapping[str, Target]:
        """The targets by their ids, in their order."""
        return {target.id: target for target in self.targets}

    @property
    def mounted_tool(self) -> Tool:
        """The tool, resolved."""
        assert isinstance(self.tool, Tool)
        return self.tool

    @property
    def start(self) -> tuple[float, ...]:
        """The start posture, resolved [rad]."""
        assert self.start_joints is not None
        return tuple(self.start_joints)

    @cached_property
    def joint_weights(self) -> tuple[float, ...]:
        """The weight of each joint in the effort, resolved."""
        if self.options.joint_weights is not None:
            return tuple(float(weight) for weight in self.options.joint_weights)
        if self.options.weights == "torque":
            return torque_weights(self.robot, self.mounted_tool)
        return (1.0,) * len(self.robot.joints)


def _resolved(options: Options, problem: Problem) -> Options:
    include = options.include
    if include is None:
        include = FULL_ANSWER if len(problem.targets) <= FULL_ANSWER_TARGETS else ("path",)
    values: dict[str, Any] = {entry.name: getattr(options, entry.name) for entry in fields(Options)}
    values["include"] = tuple(include)
    if options.position_margin_m is None:
        closed_form = has_closed_form(problem.robot, problem.mounted_tool)
        values["position_margin_m"] = DEFAULT_POSITION_MARGIN_M if closed_form else 0.0
    if options.joint_weights is not None:
        values["joint_weights"] = tuple(float(weight) for weight in options.joint_weights)
    return Options(**values)
