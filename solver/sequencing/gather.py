"""From targets with their feasible arcs to a batch for the kernels."""

from collections.abc import Sequence

import numpy as np

from solver.approach.task.packed import LOWER, UPPER, jump_cosines
from solver.problem.effort import cost_scale
from solver.problem.problem import Problem
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc
from solver.robots.model import Array
from solver.sequencing.batch import Batch


def gather(problem: Problem, numbers: Array, arcs: Sequence[Sequence[Arc]]) -> Batch:
    """The batch of some targets of a problem, from its start posture.

    Args:
        problem: robot, tool and options; its own targets play no part.
        numbers: the targets as `packed_targets` packs them, shape (sides, n, NUMBERS).
        arcs: the feasible arcs of each, n of them; one without length is a single approach.
    """
    options, sides = problem.options, len(numbers)
    rows = [
        (sides * k + (1 - arc.tool_side) // 2, arc.branch, arc.lower_rad, arc.upper_rad)
        for k, own in enumerate(arcs)
        for arc in own
    ]
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    retreats = looked_at_retreats(options)
    scale = cost_scale(np.asarray(problem.joint_weights), options.norm)
    limits = numbers[0, 0]
    return Batch(
        numbers=np.ascontiguousarray(np.swapaxes(numbers, 0, 1).reshape(-1, numbers.shape[2])),
        retreats=retreats,
        cos_steps=jump_cosines(retreats),
        arc_frames=np.ascontiguousarray(table[:, 0], dtype=np.int64),
        arc_branches=np.ascontiguousarray(table[:, 1], dtype=np.int64),
        arc_lower=np.ascontiguousarray(table[:, 2]),
        arc_upper=np.ascontiguousarray(table[:, 3]),
        first_arc=np.concatenate(([0], np.cumsum([len(own) for own in arcs]))).astype(np.int64),
        scale=scale,
        start=scale * np.asarray(problem.start),
        squared=options.squared,
        turning=bool(np.any(limits[UPPER : UPPER + 6] - limits[LOWER : LOWER + 6] >= 2 * np.pi)),
    )
