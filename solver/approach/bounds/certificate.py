"""A proven lower bound on the effort of a target's unrelaxed task."""

import math
from dataclasses import dataclass

from solver.approach.bounds.bounding import prove
from solver.approach.bounds.tolerances import CERTIFICATE_CELLS, CERTIFICATE_GAP
from solver.approach.task.task import ApproachTask


@dataclass(frozen=True)
class Certificate:
    """What branch and bound has proven of a task.

    Attributes:
        lower_bound: no approach angle, branch or tool side with a feasible cut-in has an effort
            below it; infinity: there is no feasible approach.
        known_effort: the least effort known to be possible, the incumbent or one that the search
            found; infinity: none.
        cells: cells of approach angles looked at.
        complete: the bound is within CERTIFICATE_GAP of `known_effort`, or infinity; if false the
            budget ended first, and the bound is valid all the same.
    """

    lower_bound: float
    known_effort: float
    cells: int
    complete: bool


def certify_task(
    task: ApproachTask, incumbent: float | None, most_cells: int = CERTIFICATE_CELLS
) -> Certificate:
    """Branch and bound over the approach angle with interval arithmetic.

    A cell is closed when limits or reach are certainly broken at thinning or at another row of the
    cut-in, or a joint certainly turns too far between two rows, or the least effort that its
    intervals allow is near enough to the least known.

    Args:
        task: the task; limits widened by the verifier's LIMIT_EXCESS_RAD.
        incumbent: an effort that a method reached, None if it reached none. The search finds its
            own where that is not the least.
        most_cells: budget for all tool sides together.
    """
    known = math.inf if incumbent is None else incumbent
    bound, cells, complete = math.inf, 0, True
    for side in task.tool_sides:
        kernel_task = task.for_kernels(side)
        proven, known, looked_at, done = prove(
            kernel_task, known, CERTIFICATE_GAP, most_cells - cells
        )
        bound, cells, complete = min(bound, proven), cells + looked_at, complete and done
    return Certificate(float(bound), float(known), int(cells), bool(complete))


def is_infeasible(task: ApproachTask) -> bool:
    """Whether it is proven that no approach of the task is feasible."""
    return certify_task(task, None).lower_bound == math.inf
