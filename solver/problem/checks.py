"""What keeps a problem from making sense, each fault with the path of its field."""

import math
from collections.abc import Iterable, Sequence

from solver.exceptions import Fault
from solver.frames.checks import direction_fault, vector_fault
from solver.kinematics.families.registry import why_no_closed_form
from solver.problem.options import (
    BACKEND_NAMES,
    INCLUDES,
    METHOD_NAMES,
    MOST_WEIGHT,
    NORMS,
    ORDERS,
    QP_SOLVER_NAMES,
    RANGES,
    WEIGHTS,
    Options,
)
from solver.problem.targets import Target
from solver.problem.tolerances import LARGEST_STD_REACHES, UNIT_MISTAKE_REACHES
from solver.robots.model import Robot, Tool


def problem_faults(
    robot: Robot,
    tool: Tool,
    targets: Sequence[Target],
    start: Sequence[float],
    options: Options,
) -> Iterable[Fault]:
    """Everything that is wrong with what is asked of a robot with a tool, from a start posture."""
    yield from _start_faults(robot, start)
    yield from _option_faults(options, len(robot.joints))
    yield from _certify_faults(options)
    yield from _closed_form_faults(robot, tool, targets, options)
    yield from _weight_faults(options, robot)
    yield from _target_faults(targets, robot.reach_m(tool))


def _start_faults(robot: Robot, start: Sequence[float]) -> Iterable[Fault]:
    if problem := vector_fault(start, len(robot.joints)):
        yield Fault(("start_joints",), problem)
        return
    for i, (joint, value) in enumerate(zip(robot.joints, start, strict=True)):
        if not joint.lower <= value <= joint.upper:
            yield Fault(
                ("start_joints", i),
                f"outside the limits of {joint.name}, "
                f"{joint.lower:.6g} to {joint.upper:.6g} {joint.unit}",
            )


def _option_faults(options: Options, joints: int) -> Iterable[Fault]:
    choices = {
        "method": METHOD_NAMES,
        "order": ORDERS,
        "norm": NORMS,
        "weights": WEIGHTS,
        "nlp_backend": BACKEND_NAMES,
        "qp_solver": QP_SOLVER_NAMES,
    }
    for name, known in choices.items():
        value = getattr(options, name)
        if value not in known:
            detail = f"not available; available: {', '.join(known)}"
            yield Fault(("options", name), detail)
    for name, (lowest, highest) in RANGES.items():
        value = getattr(options, name)
        if value is not None and not lowest <= value <= highest:
            yield Fault(("options", name), f"must be between {lowest:g} and {highest:g}")
    if options.standoff_m < options.strike_zone_m <= RANGES["strike_zone_m"][1]:
        # Or the target would be between the forks at standby already.
        yield Fault(("options", "strike_zone_m"), "must not be longer than standoff_m")
    for i, part in enumerate(options.include or ()):
        if part not in INCLUDES:
            detail = f"not available; available: {', '.join(INCLUDES)}"
            yield Fault(("options", "include", i), detail)
    if options.joint_weights is not None:
        if problem := vector_fault(options.joint_weights, joints):
            yield Fault(("options", "joint_weights"), problem)
        elif min(options.joint_weights) < 0 or not 0 < max(options.joint_weights) <= MOST_WEIGHT:
            detail = f"weights are between 0 and {MOST_WEIGHT:g}, and not all zero"
            yield Fault(("options", "joint_weights"), detail)


def _certify_faults(options: Options) -> Iterable[Fault]:
    if not options.certify:
        return
    for name in ("strike_zone_m", "tilt_tolerance_rad"):
        if getattr(options, name) != 0.0:
            detail = f"bounds the task without relaxations only; {name} is not zero"
            yield Fault(("options", "certify"), detail)


def _closed_form_faults(
    robot: Robot, tool: Tool, targets: Sequence[Target], options: Options
) -> Iterable[Fault]:
    """What only an arm with a closed form, and not on a rail, can have."""
    asked: list[tuple[str | int, ...]] = [
        ("options", name)
        for name in ("strike_zone_m", "tilt_tolerance_rad", "position_margin_m")
        if getattr(options, name)
    ]
    uncertain = [
        ("targets", k, "position_std_m")
        for k, target in enumerate(targets)
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
    if (why_not := why_no_closed_form(robot, tool)) is not None:
        for path in (*asked, *uncertain):
            yield Fault(path, f"this needs the closed form: {why_not}")


def _weight_faults(options: Options, robot: Robot) -> Iterable[Fault]:
    wanted = options.weights == "torque" and options.joint_weights is None
    if wanted and not robot.has_masses:
        detail = f"the model of {robot.name} has no masses to take torques from"
        yield Fault(("options", "weights"), detail)


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
        if problem := vector_fault(target.position_m, 3):
            yield Fault(("targets", k, "position_m"), problem)
        elif math.hypot(*target.position_m) > UNIT_MISTAKE_REACHES * reach_m:
            yield Fault(
                ("targets", k, "position_m"),
                f"more than {UNIT_MISTAKE_REACHES:g} times the reach away; positions are metres",
            )
        if problem := direction_fault(target.branch_direction):
            yield Fault(("targets", k, "branch_direction"), problem)
        if target.position_std_m is None:
            continue
        # Written so that a value that is not a number is a fault.
        if not 0 <= target.position_std_m <= LARGEST_STD_REACHES * reach_m:
            yield Fault(
                ("targets", k, "position_std_m"),
                f"must be between 0 and {LARGEST_STD_REACHES:g} times the reach, in metres",
            )
