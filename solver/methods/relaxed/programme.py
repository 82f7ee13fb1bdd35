"""The relaxed programme from one start, and the exact optimum where it ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.approach.task.relaxation import Placement
from solver.approach.task.task import ApproachTask
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import Start, make_instance, placed, shape_of
from solver.methods.relaxed.points import Point
from solver.problem.effort import posture_effort
from solver.problem.retreats import even_retreats


@dataclass(frozen=True)
class ProgrammeEnd:
    """Where the programme ended; nothing in it is verified.

    Attributes:
        status: "solved", or what went wrong.
        iterations: of the backend.
        effort: of the thinning posture.
        placement: approach angle, strike and swing.
    """

    status: str
    iterations: int
    effort: float
    placement: Placement


def programme_from(
    task: ApproachTask, point: Point, next_thinning: Sequence[float] | None = None
) -> ProgrammeEnd:
    """The relaxed programme, with limits at thinning and standby alone, from a point of its zone.

    What else a cut-in has to hold, the closed form looks after at the strike and swing found. A
    programme that ends in numbers that are none has not left its start.
    """
    seen = point.placement
    start = Start(
        point.tool_side,
        seen.approach_angle_rad,
        seen.approach_angle_rad - np.pi,
        seen.approach_angle_rad + np.pi,
        point.postures,
        even_retreats(task.options, 2)[::-1],
        seen.strike_m,
        seen.swing_rad,
    )
    programme = build_programme(task.robot, shape_of(task, coupled=next_thinning is not None))
    instance = make_instance(task, programme, start, next_thinning)
    result = solve_instance(task.robot, instance, task.options)
    if not np.isfinite(result.x).all():
        return ProgrammeEnd(result.status, result.iterations, point.effort, seen)
    thinning = result.x[: programme.joints]
    effort = posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)
    ended = placed(task, programme, result.x)
    return ProgrammeEnd(result.status, result.iterations, effort, ended)
