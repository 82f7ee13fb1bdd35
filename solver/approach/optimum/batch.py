"""The closed form's optimum for many targets at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.arcs.arcs import Arc, limit_names, named_arc
from solver.approach.optimum.batch_search import NO_BRANCH, arcs_of_many, optimise, paths_of_many
from solver.approach.task.frame import approach_frames
from solver.approach.task.packed import jump_cosines, pack
from solver.approach.task.task import approach_task
from solver.approach.uncertainty.robustness import robust_arcs
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem.problem import Problem, Target
from solver.robots.model import Array
from solver.robots.rigid import inverse
from solver.tolerances import BATCH_PART, EXCHANGE_DENSITY

__all__ = ["NO_BRANCH", "Optima", "chosen_paths", "closed_form_optima", "feasible_arcs"]


@dataclass(frozen=True)
class Optima:
    """The approach of least effort for n targets; rows of targets without one are not a number.

    Attributes:
        angles_rad: approach angles, not wrapped, shape (n,) [rad].
        tool_sides: 1 or -1, shape (n,).
        branches: 0 to 7, NO_BRANCH where a target has no feasible arc, shape (n,).
        efforts: shape (n,).
        paths: the cut-ins, standby first, shape (n, rows, 6) [rad].
        refined: cells of the effort that were looked at closely, shape (n,).
    """

    angles_rad: Array
    tool_sides: NDArray[np.int64]
    branches: NDArray[np.int64]
    efforts: Array
    paths: Array
    refined: NDArray[np.int64]


def closed_form_optima(
    problem: Problem, positions: Array, directions: Array, references: Array
) -> Optima:
    """The global optimum over every feasible arc of every branch, for n targets of a problem.

    Args:
        problem: robot, tool and options; its own targets play no part.
        positions: shape (n, 3) [m].
        directions: branch directions of any length, shape (n, 3).
        references: postures from which effort counts, shape (n, 6) or (6,) [rad].
    """
    options = problem.options
    retreats = np.linspace(options.standoff_m, 0.0, options.path_points)
    n = len(positions)
    found = (
        np.empty(n),
        np.ones(n, dtype=np.int64),
        np.empty(n, dtype=np.int64),
        np.empty(n),
        np.empty((n, len(retreats), 6)),
        np.empty(n, dtype=np.int64),
    )
    everywhere = np.broadcast_to(references, (n, 6))
    for first in range(0, n, BATCH_PART):
        part = slice(first, first + BATCH_PART)
        numbers = packed_targets(problem, positions[part], directions[part], everywhere[part])
        fields = (field[part] for field in found)
        optimise(numbers, retreats, jump_cosines(retreats), *fields)
    return Optima(*found)


def feasible_arcs(problem: Problem) -> dict[str, tuple[Arc, ...]]:
    """The feasible arcs of every target of a problem by its id, empty where it has none.

    They are those of the task without a strike zone and a tilt tolerance, at `path_points` rows.

    Raises:
        UnsupportedKinematics: the robot has no closed form.
    """
    return arcs_of_packed(problem, packed_problem(problem))


def packed_problem(problem: Problem) -> Array:
    """A problem's own targets seen from its start posture, shape (sides, n, NUMBERS)."""
    positions = np.array([target.position_m for target in problem.targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in problem.targets], dtype=np.float64)
    return packed_targets(problem, positions, directions, np.asarray(problem.start))


def arcs_of_packed(problem: Problem, numbers: Array) -> dict[str, tuple[Arc, ...]]:
    """`feasible_arcs` for targets that are packed already."""
    targets, options = problem.targets, problem.options
    retreats = np.linspace(options.standoff_m, 0.0, options.path_points)
    table = arcs_of_many(numbers, retreats, jump_cosines(retreats))
    found: dict[str, list[Arc]] = {target.id: [] for target in targets}
    names = limit_names(problem.robot)
    for k, side, *arc in table.tolist():
        found[targets[int(k)].id].append(named_arc(1 - 2 * int(side), arc, names))
    return {target.id: _robust(problem, target, found[target.id]) for target in targets}


def _robust(problem: Problem, target: Target, arcs: list[Arc]) -> tuple[Arc, ...]:
    if not target.position_std_m:
        return tuple(arcs)
    return robust_arcs(approach_task(problem, target, problem.start), arcs)


@dataclass(frozen=True)
class ChosenPaths:
    """Cut-ins at chosen approaches.

    Attributes:
        joints: standby first, shape (n, rows, 6) [rad].
        suspicious: whether a joint may leave its limits between two rows, shape (n,).
    """

    joints: Array
    suspicious: NDArray[np.bool_]


def chosen_paths(
    problem: Problem, numbers: Array, arcs: Sequence[Arc], angles_rad: Array
) -> ChosenPaths:
    """The cut-ins of n packed targets, each on an arc of its own at an angle, shape (n,) [rad]."""
    options = problem.options
    sides = np.array([(1 - arc.tool_side) // 2 for arc in arcs])
    branches = np.array([arc.branch for arc in arcs])
    retreats = np.linspace(options.standoff_m, 0.0, options.path_points)
    n = len(arcs)
    joints, suspicious = np.empty((n, len(retreats), 6)), np.empty(n, dtype=np.bool_)
    own = np.ascontiguousarray(numbers[sides, np.arange(n)])
    paths_of_many(own, branches, angles_rad, retreats, jump_cosines(retreats), joints, suspicious)
    return ChosenPaths(joints, suspicious)


def finer_paths(
    problem: Problem,
    positions: Array,
    directions: Array,
    optima: Optima,
    which: NDArray[np.int64],
) -> ChosenPaths:
    """Cut-ins of some of many targets' optima, with EXCHANGE_DENSITY rows for each one.

    Arguments are those of `closed_form_optima` and its answer; `which` are indices of targets.
    """
    options = problem.options
    numbers = packed_targets(
        problem, positions[which], directions[which], np.asarray(problem.start)
    )
    own = np.ascontiguousarray(numbers[(1 - optima.tool_sides[which]) // 2, np.arange(len(which))])
    rows = (options.path_points - 1) * EXCHANGE_DENSITY + 1
    retreats = np.linspace(options.standoff_m, 0.0, rows)
    joints, suspicious = np.empty((len(which), rows, 6)), np.empty(len(which), dtype=np.bool_)
    paths_of_many(
        own,
        optima.branches[which],
        optima.angles_rad[which],
        retreats,
        jump_cosines(retreats),
        joints,
        suspicious,
    )
    return ChosenPaths(joints, suspicious)


def packed_targets(
    problem: Problem, positions: Array, directions: Array, references: Array
) -> Array:
    """Targets for the inner loops by tool side and target, shape (sides, n, NUMBERS)."""
    options, robot = problem.options, problem.robot
    geometry = wrist_geometry(robot, problem.mounted_tool)
    limits = (
        robot.lower + options.limit_margin_rad,
        robot.upper - options.limit_margin_rad,
    )
    branch, outward, sideways = approach_frames(positions, directions)
    mount = inverse(robot.mount)
    turn = mount[:3, :3].T
    placed = positions @ turn + mount[:3, 3]
    sides = (1, -1) if options.symmetric_tool else (1,)
    return np.stack(
        [
            pack(
                geometry,
                limits,
                (placed, side * branch @ turn, outward @ turn, sideways @ turn),
                references,
                np.asarray(problem.joint_weights),
                options.norm == "l2",
            )
            for side in sides
        ]
    )
