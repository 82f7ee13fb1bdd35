"""`ncos` on a batch: a target's programme, from the ladder graph, coupled with the next."""

from collections.abc import Sequence
from dataclasses import replace

from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.optimum.on_arcs import ArcOptimum
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.candidates import at_angle
from solver.methods.coupling import Coupling
from solver.methods.ncos import improved
from solver.methods.relaxed.approach import between_neighbours
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
    if task.options.relaxed:
        return _relaxed(task, stop, next_thinning)
    start = ArcOptimum(stop.arc, stop.angle_rad, stop.candidate.effort, 0)
    candidate = improved(task, start, next_thinning)
    if broken_between(task, candidate) is not None:
        return replace(stop.candidate, status="warm_start_after_broken_limit")
    return candidate


def _relaxed(task: ApproachTask, stop: Stop, next_thinning: Sequence[float] | None) -> Candidate:
    """The same with the relaxations, from the approach that the ladder graph chose without them."""
    coupling = Coupling(task, next_thinning)
    chosen = stop.candidate
    kept = at_angle(task, stop.angle_rad, chosen.tool_side, stop.arc.branch, chosen.thinning_joints)
    candidate = between_neighbours(task, kept, coupling)
    whole = [one for one in (candidate, *candidate.others) if broken_between(task, one) is None]
    if not whole:
        return replace(kept, status="warm_start_after_broken_limit")
    return replace(
        whole[0], status=candidate.status, iterations=candidate.iterations, others=tuple(whole[1:])
    )
