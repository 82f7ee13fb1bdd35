"""A compiled sweep of approach angles: every branch, no refinement, no cleverness."""

import numpy as np

from solver.approach.arcs.arcs import sample_angles
from solver.approach.task.feasibility import effort, thinning, trace
from solver.approach.task.task import ApproachTask
from solver.compiled import kernel


@kernel
def _sweep(task, angles):  # type: ignore[no-untyped-def]
    rows = np.empty((len(task.retreats), 6))
    best = np.inf
    for angle in angles:
        for branch in range(8):
            if thinning(task, angle, branch, rows[-1]) < 0:
                continue
            # The whole cut-in may put a joint on a dearer turn than thinning alone.
            cheaper = effort(task, rows[-1]) < best
            if cheaper and trace(task, angle, branch, task.retreats, rows) >= 0:
                best = min(best, effort(task, rows[-1]))
    return best


def least_effort_of_sweep(task: ApproachTask, angles: int) -> float:
    """Least effort of evenly spaced angles with a feasible cut-in; infinity when there is none."""
    return float(min(_sweep(task.for_kernels(s), sample_angles(angles)) for s in task.tool_sides))
