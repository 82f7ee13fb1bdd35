"""`ncos` on an arm without a closed form: the programme from numerical warm starts."""

from dataclasses import replace

import numpy as np

from solver.approach.numerical.warm_start import (
    NumericalStart,
    numerical_warm_starts,
    polished_thinning,
)
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import make_instance, shape_of
from solver.methods.nlp.starts import start_at
from solver.methods.tolerances import NUMERICAL_PROGRAMMES
from solver.problem.effort import posture_effort
from solver.problem.solution import Reason

_SOLVED = "solved"


def solve_other_arm(task: ApproachTask) -> Candidate | Reason:
    """The best of the programme's approaches, or the best warm start where that is not dearer.

    The programme starts from the cheapest few. Each optimum is local: with a numerical inverse
    nobody knows that all solutions were seen. It is polished by Newton's method, and one whose
    whole cut-in does not hold makes way for the others.
    """
    starts = numerical_warm_starts(task, NUMERICAL_PROGRAMMES)
    if isinstance(starts, Reason):
        return starts
    answers = [_from_start(task, start) for start in starts]
    iterations = sum(answer.iterations for answer in answers)
    solved = [answer for answer in answers if answer.status == _SOLVED]
    best = min(solved, key=lambda answer: answer.effort, default=None)
    if best is not None and best.effort <= starts[0].effort:
        return replace(best, iterations=iterations)
    return _candidate(starts[0], iterations, answers[0].status)


def _from_start(task: ApproachTask, start: NumericalStart) -> Candidate:
    """The programme's approach from one start, or that start where it is no better."""
    from_here = start_at(task, start.tool_side, None, np.asarray(start.thinning_joints))
    programme = build_programme(task.robot, shape_of(task))
    instance = make_instance(task, programme, from_here)
    result = solve_instance(task.robot, instance, task.options)
    if not result.success:
        return _candidate(start, result.iterations, f"warm_start_after_{result.status}")
    angle = signed_angle(float(result.x[programme.angle]))
    near = np.clip(result.x[: programme.joints], task.lower, task.upper)
    polished = polished_thinning(task, angle, start.tool_side, near)
    if polished is None:
        return _candidate(start, result.iterations, "warm_start_kept_cut_in_breaks")
    cost = posture_effort(polished, task.reference, task.joint_weights, task.options.norm)
    if cost > start.effort:
        return _candidate(start, result.iterations, "solved_warm_start_as_good")
    better = NumericalStart(angle, start.tool_side, polished, cost)
    return _candidate(better, result.iterations, _SOLVED)


def _candidate(start: NumericalStart, iterations: int, status: str) -> Candidate:
    return Candidate(
        approach_angle_rad=start.approach_angle_rad,
        tool_side=start.tool_side,
        branch=None,
        thinning_joints=tuple(float(value) for value in start.thinning_joints),
        effort=start.effort,
        iterations=iterations,
        status=status,
    )
