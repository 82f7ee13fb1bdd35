"""From tasks with their feasible arcs to a batch for the kernels."""

from collections.abc import Sequence

import numpy as np

from solver.approach.arcs import Arc
from solver.approach.task import ApproachTask
from solver.sequencing.batch import Batch


def gather(tasks: Sequence[ApproachTask], arcs: Sequence[Sequence[Arc]]) -> Batch:
    """The batch of some tasks, all of one problem and seen from its start posture.

    Args:
        tasks: at least one.
        arcs: the feasible arcs of each; one without length is a single approach.
    """
    shared = tasks[0].for_kernels(1)
    sides = tasks[0].tool_sides
    frames = np.empty((len(sides) * len(tasks), 12))
    for k, task in enumerate(tasks):
        for s, side in enumerate(sides):
            own = task.for_kernels(side)
            frames[len(sides) * k + s] = np.concatenate(
                (own.position, own.y_axis, own.outward, own.sideways)
            )
    rows = [
        (len(sides) * k + sides.index(arc.tool_side), arc.branch, arc.lower_rad, arc.upper_rad)
        for k, own in enumerate(arcs)
        for arc in own
    ]
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    weights = shared.weights
    return Batch(
        task=shared,
        frames=frames,
        arc_frames=np.ascontiguousarray(table[:, 0], dtype=np.int64),
        arc_branches=np.ascontiguousarray(table[:, 1], dtype=np.int64),
        arc_lower=np.ascontiguousarray(table[:, 2]),
        arc_upper=np.ascontiguousarray(table[:, 3]),
        first_arc=np.concatenate(([0], np.cumsum([len(own) for own in arcs]))).astype(np.int64),
        scale=np.sqrt(weights) if shared.squared else weights,
        turning=bool(np.any(shared.upper - shared.lower >= 2 * np.pi)),
    )
