"""Prunus's solver: approach optimisation for blossoms on branches, without a server.

    >>> from solver import Problem, Target, load_robot, solve
    >>> target = Target("1", position_m=(0.185, -0.057, 0.42), branch_direction=(-1, -1, 1))
    >>> plan = solve(Problem(load_robot("tabletop"), [target]))
    >>> approach = plan.approaches[0]
    >>> approach.status, approach.branch, round(approach.approach_angle_rad, 4)
    ('planned', 2, 0.1281)
    >>> plan
    <Plan for tabletop: 1 planned, 0 infeasible, total effort 3.451>

The kinematics behind it, for one posture or for many:

    >>> from solver import forward_kinematics, inverse_kinematics, jacobian
    >>> robot, tool = plan.problem.robot, plan.problem.mounted_tool
    >>> pose = forward_kinematics(robot, tool, approach.thinning_joints)
    >>> pose[:3, 3].round(3).tolist()
    [0.185, -0.057, 0.42]
    >>> every_branch = inverse_kinematics(robot, tool, pose[None])
    >>> every_branch.joints.shape, bool(every_branch.reachable.all())
    ((1, 8, 6), True)
    >>> jacobian(robot, tool, approach.thinning_joints).shape
    (6, 6)

Metres, radians and seconds in the robot's base frame throughout.
"""

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final

_HOMES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "solver.approach.arcs.arcs": ("Survey", "survey_target"),
        "solver.approach.arcs.of_problem": ("feasible_arcs",),
        "solver.approach.task.frame": ("ApproachFrame", "approach_frame"),
        "solver.approach.task.relaxation": ("placement",),
        "solver.exceptions": (
            "Fault",
            "InvalidProblem",
            "InvalidRobot",
            "RetimingFailed",
            "SolverError",
            "UnknownEntrant",
            "UnknownRobot",
            "UnknownScenario",
            "UnsupportedKinematics",
        ),
        "solver.frames.point_pairs": ("PointPair",),
        "solver.frames.registration": ("Agreement", "check_frame", "register_frame"),
        "solver.frames.transforms": (
            "FrameWarning",
            "NamedFrame",
            "RigidTransform",
            "transform_from_matrix",
            "transform_from_quaternion",
        ),
        "solver.kinematics.families.registry": ("family_of",),
        "solver.kinematics.forward": ("forward_kinematics", "jacobian", "link_transforms"),
        "solver.kinematics.spherical_wrist": ("InverseSolutions", "inverse_kinematics"),
        "solver.kinematics.torque_weights": ("torque_parts", "torque_weights"),
        "solver.methods.registry": ("METHODS",),
        "solver.motion.timing": ("time_joint_line",),
        "solver.problem.options": (
            "BACKEND_NAMES",
            "DEFAULT_POSITION_MARGIN_M",
            "FULL_ANSWER",
            "FULL_ANSWER_TARGETS",
            "INCLUDES",
            "METHOD_NAMES",
            "MOST_WEIGHT",
            "NORMS",
            "ORDERS",
            "Options",
            "QP_SOLVER_NAMES",
            "RANGES",
            "WEIGHTS",
        ),
        "solver.problem.plan": ("Plan",),
        "solver.problem.problem": ("Problem",),
        "solver.problem.solution": (
            "Approach",
            "Arc",
            "Nearest",
            "INFEASIBLE",
            "PLANNED",
            "REASON_CODES",
            "Reason",
            "Segment",
            "SolverReport",
            "Trajectory",
            "Transfer",
        ),
        "solver.problem.targets": ("Target", "targets_in_base"),
        "solver.problem.thinning": (
            "Blossom",
            "BlossomBranch",
            "PlacedBlossom",
            "ThinningSelection",
            "select_blossoms",
        ),
        "solver.robots.files": ("load_robot", "parse_robot", "robot_names"),
        "solver.robots.model": ("Array", "Joint", "Link", "PRISMATIC", "REVOLUTE", "Robot", "Tool"),
        "solver.robots.toml_writing": ("robot_to_toml",),
        "solver.solving.many_targets": ("plans_together",),
        "solver.solving.retiming": ("ChosenApproach", "retime"),
        "solver.solving.solve": ("solve",),
        "solver.solving.staged": (
            "Choice",
            "choice_from_json",
            "choice_to_json",
            "choose",
            "next_reference",
            "plan_part",
        ),
        "solver.urdf.reading": ("robot_from_urdf",),
        "solver.urdf.writing": ("robot_to_urdf",),
        "solver.verification.verdict": ("Residual", "Verification"),
        "solver.verification.verify": ("verify", "verify_plan"),
    }
)
"""Where each public name is defined. It is imported when it is asked for, since whoever needs the
model of a robot, as a worker does, should not wait for compilers and optimisers; `__init__.pyi`
says the same to type checkers."""

_MODULES: Final = MappingProxyType(
    {name: module for module, names in _HOMES.items() for name in names}
)
__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_MODULES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_MODULES})
