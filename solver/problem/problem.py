"""What is asked: targets, options and the robot, frozen and checked as a whole.

Field names are those of the request's JSON, so that a fault points to the same place in both.
Lengths in metres, angles in radians, everything in the robot's base frame.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Final, overload

from solver.exceptions import Fault, InvalidProblem
from solver.frames.transforms import NamedFrame
from solver.kinematics.families.registry import family_of
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


@dataclass(frozen=True, init=False)
class Problem:
    """A batch of targets for one robot with one tool, from one start posture.

    Targets are in the base frame. Construction checks everything:

    Attributes:
        robot: the arm.
        targets: of which an approach is wanted to each.
        options: how to solve.
        tool: one of the robot's by its name, or another; by default the robot's own.
        start_joints: the start posture, shape (joints,) [rad or m]; by default the robot's home.
        frame: in which other frame the targets were sent, if in one (`targets_in_base`).

    Raises:
        InvalidProblem: with every fault found, each with the path of its field.
    """

    robot: Robot
    targets: Sequence[Target]
    options: Options
    tool: Tool | str | None
    start_joints: Sequence[float] | None
    frame: NamedFrame | None

    @overload
    def __init__(
        self,
        robot: Robot,
        targets: Sequence[Target],
        options: Options | None = None,
        *,
        tool: Tool | str | None = None,
        start_joints: Sequence[float] | None = None,
        frame: NamedFrame | None = None,
    ) -> None: ...

    @overload
    def __init__(
        self,
        robot: Robot,
        targets: Sequence[Target],
        tool: Tool | str | None,
        start_joints: Sequence[float] | None = None,
        options: Options | None = None,
        frame: NamedFrame | None = None,
    ) -> None: ...

    def __init__(
        self, robot: Robot, targets: Sequence[Target], *third: Any, **by_name: Any
    ) -> None:
        placed = _by_place(third)
        if wrong := (placed.keys() & by_name.keys()) | (by_name.keys() - _BY_NAME):
            raise TypeError(f"unknown to Problem, or given twice: {', '.join(sorted(wrong))}")
        given = dict.fromkeys(_BY_NAME) | placed | by_name
        targets = tuple(targets)
        faults = [
            Fault(("targets", k), f"a Target is wanted, not a {type(one).__name__}; {_MAKE_ONE}")
            for k, one in enumerate(targets)
            if not isinstance(one, Target)
        ]
        if faults:
            raise InvalidProblem(tuple(faults))
        options = given["options"] or Options()
        object.__setattr__(self, "robot", robot)
        object.__setattr__(self, "targets", targets)
        object.__setattr__(self, "tool", given["tool"])
        object.__setattr__(self, "frame", given["frame"])
        tool = self._resolve_tool(faults)
        start = robot.home_joints if given["start_joints"] is None else given["start_joints"]
        faults += problem_faults(robot, tool, self.targets, start, options)
        if faults:
            raise InvalidProblem(tuple(faults))
        object.__setattr__(self, "tool", tool)
        object.__setattr__(self, "start_joints", tuple(float(value) for value in start))
        object.__setattr__(self, "options", _resolved(options, self))

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


_BY_NAME: Final = frozenset({"options", "tool", "start_joints", "frame"})
_IN_OLD_ORDER: Final = ("tool", "start_joints", "options", "frame")
_MAKE_ONE: Final = "Target(**it) makes one of a dict with its fields"


def _by_place(third: tuple[Any, ...]) -> dict[str, Any]:
    """What stands behind robot and targets: the options, or as it was until 0.1 the tool first."""
    if len(third) == 1 and isinstance(third[0], Options | None):
        return {"options": third[0]}
    if third:
        warnings.warn(
            "behind robot and targets Problem takes options; give tool, start_joints and frame by "
            "name",
            DeprecationWarning,
            stacklevel=3,
        )
    return dict(zip(_IN_OLD_ORDER, third, strict=False))


def _resolved(options: Options, problem: Problem) -> Options:
    include = options.include
    if include is None:
        include = FULL_ANSWER if len(problem.targets) <= FULL_ANSWER_TARGETS else ("path",)
    values: dict[str, Any] = {entry.name: getattr(options, entry.name) for entry in fields(Options)}
    values["include"] = tuple(include)
    if options.position_margin_m is None:
        closed_form = family_of(problem.robot, problem.mounted_tool).has_closed_form
        values["position_margin_m"] = DEFAULT_POSITION_MARGIN_M if closed_form else 0.0
    if options.joint_weights is not None:
        values["joint_weights"] = tuple(float(weight) for weight in options.joint_weights)
    return Options(**values)
