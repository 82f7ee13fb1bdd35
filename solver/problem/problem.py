"""What is asked: targets, options and the robot, frozen and checked as a whole.

Field names are those of the request's JSON, so that a fault points to the same place in both.
Lengths in metres, angles in radians, everything in the robot's base frame.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

from solver.exceptions import Fault, InvalidProblem, UnsupportedKinematics
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.torque_weights import torque_weights
from solver.robots.model import Robot, Tool
from solver.tolerances import LARGEST_STD_REACHES, SHORTEST_DIRECTION, UNIT_MISTAKE_REACHES

if TYPE_CHECKING:  # it imports this module
    from solver.frames.transforms import NamedFrame

ORDERS: Final = ("independent", "given", "optimal")
NORMS: Final = ("l1", "l2")
WEIGHTS: Final = ("uniform", "torque")
FULL_ANSWER: Final = ("path", "transfer", "trajectory")
INCLUDES: Final = (*FULL_ANSWER, "arcs")
FULL_ANSWER_TARGETS: Final = 50
MOST_WEIGHT: Final = 1e6


@dataclass(frozen=True)
class Target:
    """A blossom to remove.

    Attributes:
        id: any non-empty text, once in a batch.
        position_m: the blossom in the base frame, three numbers [m].
        branch_direction: along the branch, three numbers of any length above zero; the approach
            angle turns about it as given.
    """

    id: str
    position_m: Sequence[float]
    branch_direction: Sequence[float]
    position_std_m: float | None = None


@dataclass(frozen=True)
class Options:
    """How to solve; see docs/options.md for each field's meaning and range."""

    method: str = "ncos"
    order: str = "given"
    norm: str = "l1"
    weights: str = "uniform"
    joint_weights: Sequence[float] | None = None
    standoff_m: float = 0.04
    path_points: int = 20
    straightness_m: float = 1e-4
    dwell_s: float = 5.0
    limit_margin_rad: float = 0.005
    symmetric_tool: bool = False
    strike_zone_m: float = 0.0
    tilt_tolerance_rad: float = 0.0
    samples: int = 50
    seed: int = 0
    certify: bool = False
    nlp_backend: str = "sqp"
    qp_solver: str = "daqp"
    include: Sequence[str] | None = None

    @property
    def timed(self) -> bool:
        """Whether motion is part of the answer; by default it is, up to FULL_ANSWER_TARGETS."""
        return self.include is None or not {"transfer", "trajectory"}.isdisjoint(self.include)


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
    frame: "NamedFrame | None" = None

    def __post_init__(self) -> None:
        faults: list[Fault] = []
        tool = self._resolve_tool(faults)
        object.__setattr__(self, "targets", tuple(self.targets))
        start = self.robot.home_joints if self.start_joints is None else self.start_joints
        faults += _start_faults(self.robot, start)
        faults += _option_faults(self.options, len(self.robot.joints))
        faults += _certify_faults(self.options)
        faults += _closed_form_faults(self, tool)
        faults += _weight_faults(self.options, self.robot)
        faults += _target_faults(self.targets, self.robot.reach_m(tool))
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
    if options.joint_weights is not None:
        values["joint_weights"] = tuple(float(weight) for weight in options.joint_weights)
    return Options(**values)


def _weight_faults(options: Options, robot: Robot) -> Iterable[Fault]:
    wanted = options.weights == "torque" and options.joint_weights is None
    if wanted and not robot.has_masses:
        detail = f"the model of {robot.name} has no masses to take torques from"
        yield Fault(("options", "weights"), detail)


def _start_faults(robot: Robot, start: Sequence[float]) -> Iterable[Fault]:
    if problem := _vector_problem(start, len(robot.joints)):
        yield Fault(("start_joints",), problem)
        return
    for i, (joint, value) in enumerate(zip(robot.joints, start, strict=True)):
        if not joint.lower <= value <= joint.upper:
            yield Fault(
                ("start_joints", i),
                f"outside the limits of {joint.name}, "
                f"{joint.lower:.6g} to {joint.upper:.6g} {joint.unit}",
            )


def _target_faults(targets: Sequence[Target], reach_m: float) -> Iterable[Fault]:
    if not targets:
        yield Fault(("targets",), "the batch is empty")
    first_index: dict[str, int] = {}
    for k, target in enumerate(targets):
        if not target.id:
            yield Fault(("targets", k, "id"), "the id is empty")
        elif target.id in first_index:
            yield Fault(
                ("targets", k, "id"),
                f"also the id of target {first_index[target.id]}",
            )
        first_index.setdefault(target.id, k)
        if problem := _vector_problem(target.position_m, 3):
            yield Fault(("targets", k, "position_m"), problem)
        elif math.hypot(*target.position_m) > UNIT_MISTAKE_REACHES * reach_m:
            yield Fault(
                ("targets", k, "position_m"),
                f"more than {UNIT_MISTAKE_REACHES:g} times the reach away; positions are metres",
            )
        if problem := _vector_problem(target.branch_direction, 3):
            yield Fault(("targets", k, "branch_direction"), problem)
        elif not SHORTEST_DIRECTION < math.hypot(*target.branch_direction) < math.inf:
            yield Fault(("targets", k, "branch_direction"), "the direction has no usable length")
        if target.position_std_m is None:
            continue
        # Written so that a value that is not a number is a fault.
        if not 0 <= target.position_std_m <= LARGEST_STD_REACHES * reach_m:
            yield Fault(
                ("targets", k, "position_std_m"),
                f"must be between 0 and {LARGEST_STD_REACHES:g} times the reach, in metres",
            )


def _vector_problem(values: Sequence[float], length: int) -> str | None:
    if len(values) != length:
        return f"needs {length} numbers, has {len(values)}"
    if not all(math.isfinite(value) for value in values):
        return "has a value that is not finite"
    return None


# Ranges outside which an option makes no sense: (lowest, highest), both allowed.
RANGES: Final[dict[str, tuple[float, float]]] = {
    "standoff_m": (0.001, 1.0),
    "path_points": (2, 200),
    "straightness_m": (1e-6, 0.01),
    "dwell_s": (0.0, 3600.0),
    "limit_margin_rad": (0.0, 0.5),
    "samples": (1, 10_000),
    "seed": (0, 2**63 - 1),
    "strike_zone_m": (0.0, 0.5),
    "tilt_tolerance_rad": (0.0, 0.8),
}


def _certify_faults(options: Options) -> Iterable[Fault]:
    if not options.certify:
        return
    for name in ("strike_zone_m", "tilt_tolerance_rad"):
        if getattr(options, name) != 0.0:
            detail = f"bounds the task without relaxations only; {name} is not zero"
            yield Fault(("options", "certify"), detail)


def _closed_form_faults(problem: "Problem", tool: Tool) -> Iterable[Fault]:
    """What only an arm with a closed form, and not on a rail, can have."""
    options = problem.options
    asked: list[tuple[str | int, ...]] = [
        ("options", name)
        for name in ("strike_zone_m", "tilt_tolerance_rad")
        if getattr(options, name) != 0.0
    ]
    uncertain = [
        ("targets", k, "position_std_m")
        for k, target in enumerate(problem.targets)
        if target.position_std_m
    ]
    if options.certify:
        asked.append(("options", "certify"))
    if options.order == "optimal":
        asked.append(("options", "order"))
    include = enumerate(options.include or ())
    asked += [("options", "include", i) for i, part in include if part == "arcs"]
    if not asked and not uncertain:
        return
    try:
        wrist_geometry(problem.robot, tool)
    except UnsupportedKinematics as error:
        for path in (*asked, *uncertain):
            yield Fault(path, f"this needs the closed form: {error}")


def _option_faults(options: Options, joints: int) -> Iterable[Fault]:
    from solver.methods.nlp.backends import BACKENDS  # the methods' rows import this module
    from solver.methods.nlp.quadratic import QP_SOLVERS
    from solver.methods.registry import METHODS

    choices = {
        "method": tuple(METHODS),
        "order": ORDERS,
        "norm": NORMS,
        "weights": WEIGHTS,
        "nlp_backend": tuple(BACKENDS),
        "qp_solver": QP_SOLVERS,
    }
    for name, known in choices.items():
        value = getattr(options, name)
        if value not in known:
            detail = f"not available; available: {', '.join(known)}"
            yield Fault(("options", name), detail)
    for name, (lowest, highest) in RANGES.items():
        value = getattr(options, name)
        if not lowest <= value <= highest:
            yield Fault(("options", name), f"must be between {lowest:g} and {highest:g}")
    if options.standoff_m < options.strike_zone_m <= RANGES["strike_zone_m"][1]:
        # Or the target would be between the forks at standby already.
        yield Fault(("options", "strike_zone_m"), "must not be longer than standoff_m")
    for i, part in enumerate(options.include or ()):
        if part not in INCLUDES:
            detail = f"not available; available: {', '.join(INCLUDES)}"
            yield Fault(("options", "include", i), detail)
    if options.joint_weights is not None:
        if problem := _vector_problem(options.joint_weights, joints):
            yield Fault(("options", "joint_weights"), problem)
        elif min(options.joint_weights) < 0 or not 0 < max(options.joint_weights) <= MOST_WEIGHT:
            detail = f"weights are between 0 and {MOST_WEIGHT:g}, and not all zero"
            yield Fault(("options", "joint_weights"), detail)
