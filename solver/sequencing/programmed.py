"""`ncos` on a batch: each target's programme, from the ladder graph, coupled with the next."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver.cut_in import broken_limit, retreat_rows
from solver.methods.ncos import improved
from solver.methods.semi_analytic import ArcOptimum
from solver.problem import Problem
from solver.sequencing.sequence import Stop


def programmed(problem: Problem, stops: Sequence[Stop]) -> tuple[Stop, ...]:
    """The stops after one pass of programmes, never dearer than before.

    Each programme counts the effort of its own thinning posture from the previous standby and that
    of the next thinning posture from its standby, so what it gains the batch gains.
    """
    reference: tuple[float, ...] = problem.start
    done: list[Stop] = []
    for k, stop in enumerate(stops):
        following = stops[k + 1].candidate.thinning_joints if k + 1 < len(stops) else None
        task = replace(stop.task, reference=reference)
        start = ArcOptimum(stop.arc, stop.angle_rad, stop.candidate.effort, 0)
        candidate = improved(task, start, following)
        if broken_limit(task, candidate) is not None:
            candidate = replace(stop.candidate, status="warm_start_after_broken_limit")
        done.append(replace(stop, candidate=candidate))
        ends = np.array([task.options.standoff_m, 0.0])
        standby = retreat_rows(
            task.robot, task.tool, candidate.thinning_joints, candidate.branch, ends
        )[0]
        reference = tuple(float(value) for value in standby)
    return tuple(done)
