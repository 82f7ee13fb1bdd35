"""`ncos` on a batch: a target's programme, from the ladder graph, coupled with the next."""

from dataclasses import replace

from solver.approach.cut_in.cut_in import broken_between
from solver.approach.optimum.on_arcs import ArcOptimum
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.ncos import improved
from solver.sequencing.sequence import Stop


def programmed(task: ApproachTask, stop: Stop, following: Stop | None) -> Candidate:
    """A stop's approach after its programme, never dearer for the batch than before.

    The programme counts the effort of its own thinning posture from the previous standby and that
    of the next thinning posture from its standby, so what it gains the batch gains.

    Args:
        task: the stop's, seen from the previous standby.
        stop: what the ladder graph chose.
        following: the next stop, as the ladder graph chose it.
    """
    next_thinning = None if following is None else following.candidate.thinning_joints
    start = ArcOptimum(stop.arc, stop.angle_rad, stop.candidate.effort, 0)
    candidate = improved(task, start, next_thinning)
    if broken_between(task, candidate) is not None:
        return replace(stop.candidate, status="warm_start_after_broken_limit")
    return candidate
