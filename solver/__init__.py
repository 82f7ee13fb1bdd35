"""Prunus's solver: approach optimisation for blossoms on branches, without a server.

    >>> from solver import Problem, Target, load_robot, solve
    >>> target = Target("1", position_m=(0.185, -0.057, 0.42), branch_direction=(-1, -1, 1))
    >>> plan = solve(Problem(load_robot("tabletop"), [target]))
    >>> approach = plan.approaches[0]
    >>> approach.status, approach.branch, round(approach.approach_angle_rad, 4)
    ('planned', 2, 0.1281)

Metres, radians and seconds in the robot's base frame throughout.
"""

from collections.abc import Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, Final

_HOMES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "solver.approach.arcs.of_problem": ("feasible_arcs",),
        "solver.exceptions": (
            "Fault",
            "InvalidProblem",
            "InvalidRobot",
            "SolverError",
            "UnknownRobot",
            "UnsupportedKinematics",
        ),
        "solver.solving.solve": ("solve",),
        "solver.problem.options": ("Options",),
        "solver.problem.problem": ("Problem",),
        "solver.problem.solution": (
            "Approach",
            "Arc",
            "Nearest",
            "Plan",
            "Reason",
            "Segment",
            "SolverReport",
            "Trajectory",
            "Transfer",
        ),
        "solver.problem.targets": ("Target",),
        "solver.problem.thinning": (
            "Blossom",
            "BlossomBranch",
            "PlacedBlossom",
            "ThinningSelection",
            "select_blossoms",
        ),
        "solver.robots.files": ("load_robot", "parse_robot", "robot_names"),
        "solver.robots.model": ("Joint", "Link", "Robot", "Tool"),
        "solver.robots.toml_writing": ("robot_to_toml",),
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
