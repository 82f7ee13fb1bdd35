"""`ncos` on an arm on a rail: the programme moves the slide as well."""

from dataclasses import replace

import numpy as np

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.methods.any_arm import over_rail
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import ProgrammeResult, make_instance, shape_of
from solver.methods.nlp.starts import start_at
from solver.methods.rail import at_rail, rail_effort
from solver.methods.semi_analytic import solve_ssas
from solver.methods.slide import cheapest_position
from solver.problem.solution import Reason


def solve_on_rail(task: ApproachTask, rail: Rail) -> Candidate | Reason:
    """The approach with the slide where the programme puts it, or the warm start if that is better.

    The warm start is the closed form's global optimum where the slide stands cheapest, as a search
    in the slide finds it. From there the programme moves slide, arm and approach angle together; at
    its slide position the closed form's optimum is taken. Never dearer than the grid of positions.
    """
    cheapest = cheapest_position(task, rail)
    if cheapest is None:
        return over_rail(task, rail, solve_ssas)
    place, spent = cheapest
    kept = _standing_at(task, rail, place)
    if isinstance(kept, Reason):
        return kept
    result = _programme(task, kept)
    iterations = spent + result.iterations
    if not result.success:
        status = f"warm_start_after_{result.status}"
        return replace(kept, iterations=iterations, status=status)
    position = float(np.clip(result.x[0], task.lower[0], task.upper[0]))
    found = _standing_at(task, rail, position)
    if isinstance(found, Reason) or found.effort >= kept.effort:
        return replace(kept, iterations=iterations, status="solved_warm_start_as_good")
    return replace(found, iterations=iterations + found.iterations, status="solved")


def _standing_at(task: ApproachTask, rail: Rail, position: float) -> Candidate | Reason:
    """The closed form's optimum with the slide at a position [m], the slide's travel counted."""
    found = solve_ssas(at_rail(task, rail, position))
    if isinstance(found, Reason):
        return found
    return replace(
        found,
        thinning_joints=(position, *found.thinning_joints),
        effort=found.effort + rail_effort(task, position),
    )


def _programme(task: ApproachTask, warm_start: Candidate) -> ProgrammeResult:
    thinning = np.asarray(warm_start.thinning_joints)
    start = start_at(task, warm_start.tool_side, warm_start.branch, thinning)
    programme = build_programme(task.robot, shape_of(task))
    return solve_instance(task.robot, make_instance(task, programme, start), task.options)
