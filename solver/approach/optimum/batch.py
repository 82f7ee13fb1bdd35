"""The closed form's optimum for many targets at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.optimum.at_level import raise_margins
from solver.approach.optimum.batch_search import optimise, paths_of_many
from solver.approach.task.packed import jump_cosines
from solver.approach.task.packing import packed_targets
from solver.approach.tolerances import EXCHANGE_DENSITY
from solver.problem.problem import Problem
from solver.problem.retreats import even_retreats, looked_at_retreats
from solver.problem.solution import Arc
from solver.robots.model import Array
from solver.tolerances import BATCH_PART


@dataclass(frozen=True)
class Optima:
    """The approach of least effort for n targets; rows of targets without one are not a number.

    Attributes:
        angles_rad: approach angles, not wrapped, shape (n,) [rad].
        tool_sides: 1 or -1, shape (n,).
        branches: 0 to 7, NO_BRANCH where a target has no feasible arc, shape (n,).
        efforts: shape (n,).
        paths: the cut-ins, standby first, shape (n, path_points, 6) [rad].
        suspicious: whether a cut-in may be infeasible between what was looked at, shape (n,).
        refined: cells of the effort that were looked at closely, shape (n,).
    """

    angles_rad: Array
    tool_sides: NDArray[np.int64]
    branches: NDArray[np.int64]
    efforts: Array
    paths: Array
    suspicious: NDArray[np.bool_]
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
    retreats, sent = looked_at_retreats(problem.options), even_retreats(problem.options)
    n = len(positions)
    found = (
        np.empty(n),
        np.ones(n, dtype=np.int64),
        np.empty(n, dtype=np.int64),
        np.empty(n),
        np.empty((n, len(sent), 6)),
        np.empty(n, dtype=np.bool_),
        np.empty(n, dtype=np.int64),
    )
    everywhere = np.broadcast_to(references, (n, 6))
    for first in range(0, n, BATCH_PART):
        part = slice(first, first + BATCH_PART)
        numbers = packed_targets(problem, positions[part], directions[part], everywhere[part])
        fields = (field[part] for field in found)
        optimise(numbers, retreats, jump_cosines(retreats), sent, *fields)
    return Optima(*found)


def raised_optima(
    problem: Problem,
    positions: Array,
    directions: Array,
    levels: Sequence[tuple[float, ...]],
    optima: Optima,
) -> tuple[Optima, Array]:
    """Optima that bear as much displacement of their targets as some approach does, and how much.

    Args:
        problem: robot, tool and options.
        positions: of n targets, shape (n, 3) [m].
        directions: branch directions of any length, shape (n, 3).
        levels: displacement margins to try for each target, falling, the last one needed [m].
        optima: seen from the problem's start, whatever their targets may move.

    Returns:
        The optima, without a branch where none bears what is needed, and how far each target may
        move, shape (n,) [m].
    """
    retreats, n, most = looked_at_retreats(problem.options), len(positions), max(map(len, levels))
    numbers = packed_targets(problem, positions, directions, np.asarray(problem.start))
    angles, sides = optima.angles_rad.copy(), optima.tool_sides.copy()
    branches, efforts = optima.branches.copy(), optima.efforts.copy()
    paths, suspicious = optima.paths.copy(), optima.suspicious.copy()
    margins, moved = np.empty(n), np.empty(n, dtype=np.bool_)
    table = np.array([(*own, *own[-1:] * (most - len(own))) for own in levels])
    raise_margins(
        numbers, retreats, jump_cosines(retreats), table, angles, sides, branches, efforts,
        margins, moved,
    )  # fmt: skip
    which = np.flatnonzero(moved)
    packed = np.ascontiguousarray(numbers[(1 - sides[which]) // 2, which])
    found = _paths(packed, branches[which], angles[which], retreats, even_retreats(problem.options))
    paths[which], suspicious[which] = found.joints, found.suspicious
    raised = Optima(angles, sides, branches, efforts, paths, suspicious, optima.refined)
    return raised, margins


@dataclass(frozen=True)
class ChosenPaths:
    """Cut-ins at chosen approaches.

    Attributes:
        joints: standby first, shape (n, rows, 6) [rad].
        suspicious: whether a cut-in may be infeasible between what was looked at, shape (n,).
    """

    joints: Array
    suspicious: NDArray[np.bool_]


def chosen_paths(
    problem: Problem, numbers: Array, arcs: Sequence[Arc], angles_rad: Array
) -> ChosenPaths:
    """The cut-ins of n packed targets, each on an arc of its own at an angle, shape (n,) [rad]."""
    sides = np.array([(1 - arc.tool_side) // 2 for arc in arcs])
    branches = np.array([arc.branch for arc in arcs])
    retreats = looked_at_retreats(problem.options)
    own = np.ascontiguousarray(numbers[sides, np.arange(len(arcs))])
    return _paths(own, branches, angles_rad, retreats, even_retreats(problem.options))


def _paths(
    numbers: Array, branches: NDArray[np.int64], angles_rad: Array, retreats: Array, sent: Array
) -> ChosenPaths:
    n = len(numbers)
    joints, suspicious = np.empty((n, len(sent), 6)), np.empty(n, dtype=np.bool_)
    steps = jump_cosines(retreats)
    paths_of_many(numbers, branches, angles_rad, retreats, steps, sent, joints, suspicious)
    return ChosenPaths(joints, suspicious)


def finer_paths(
    problem: Problem,
    positions: Array,
    directions: Array,
    optima: Optima,
    which: NDArray[np.int64],
) -> ChosenPaths:
    """Cut-ins of some of many targets' optima, looked at EXCHANGE_DENSITY times as closely.

    Arguments are those of `closed_form_optima` and its answer; `which` are indices of targets.
    """
    options = problem.options
    numbers = packed_targets(
        problem, positions[which], directions[which], np.asarray(problem.start)
    )
    own = np.ascontiguousarray(numbers[(1 - optima.tool_sides[which]) // 2, np.arange(len(which))])
    rows = (len(looked_at_retreats(options)) - 1) * EXCHANGE_DENSITY + 1
    return _paths(
        own,
        optima.branches[which],
        optima.angles_rad[which],
        even_retreats(options, rows),
        even_retreats(options),
    )
