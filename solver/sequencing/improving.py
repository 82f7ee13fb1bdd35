"""A stop of a batch planned as one, improved by its method between its neighbours."""

from dataclasses import replace

from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.optimum.on_arcs import ArcOptimum
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.registry import Improve
from solver.sequencing.sequence import Stop


def improved_stop(
    task: ApproachTask, stop: Stop, following: Stop | None, improve: Improve
) -> Candidate:
    """A stop's approach after its method has seen it, never dearer for the batch than before.

    What fails between the rows of its cut-in makes way for the method's other offers, and those
    for what the ladder graph chose.

    Args:
        task: the stop's, seen from the previous standby.
        stop: what the ladder graph chose.
        following: the next stop, as the ladder graph chose it.
        improve: the method's.
    """
    next_thinning = None if following is None else following.candidate.thinning_joints
    start = ArcOptimum(stop.arc, stop.angle_rad, stop.candidate.effort, 0)
    found = improve(task, start, next_thinning)
    whole = [one for one in (found, *found.others) if broken_between(task, one) is None]
    if not whole:
        return replace(stop.candidate, status="warm_start_after_broken_limit")
    return replace(
        whole[0], status=found.status, iterations=found.iterations, others=tuple(whole[1:])
    )
