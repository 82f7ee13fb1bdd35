"""Many targets planned together, without a loop in Python: exact ones, without timed motion.

What cannot be vouched for here is left to `solver.solving.one_target`: a batch only ever saves
time.
"""

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.approach.optimum.batch import Optima, chosen_paths, closed_form_optima, finer_paths
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.approach.task.frame import signed_angle
from solver.approach.task.packing import packed_targets
from solver.kinematics.families import has_closed_form, rail_of
from solver.problem.problem import Problem
from solver.problem.solution import Approach, SolverReport
from solver.problem.targets import Target
from solver.robots.model import Array
from solver.sequencing.sequence import Stop
from solver.tolerances import BATCH_PART
from solver.verification.many import ProposedPaths, judge_many

METHOD = "ssas"


def plans_together(problem: Problem) -> bool:
    """Whether targets of a problem can be planned together."""
    options = problem.options
    return (
        options.method == METHOD
        and not options.timed
        and not options.certify
        and "arcs" not in (options.include or ())
        and has_closed_form(problem.robot, problem.mounted_tool)
        and rail_of(problem.robot, problem.mounted_tool) is None
    )


def plan_stops(
    problem: Problem, stops: Sequence[Stop], reference: Sequence[float]
) -> dict[str, Approach]:
    """Planned and verified approaches of a chain by target id, up to the first that is not.

    Args:
        problem: one that `plans_together` accepts.
        stops: neighbours in a batch planned as one, whose limits hold between rows.
        reference: the standby posture before the first, shape (6,) [rad].
    """
    together = [stop for stop in stops if not stop.task.target.position_std_m]
    if len(together) < len(stops) or not stops:
        return {}
    targets = [stop.task.target for stop in stops]
    positions, directions = _vectors(targets)
    numbers = packed_targets(problem, positions, directions, np.asarray(problem.start))
    angles = np.array([stop.angle_rad for stop in stops])
    paths = chosen_paths(problem, numbers, [stop.arc for stop in stops], angles).joints
    proposed = ProposedPaths(
        target_ids=[target.id for target in targets],
        positions=positions,
        directions=directions,
        angles_rad=np.array([stop.candidate.approach_angle_rad for stop in stops]),
        tool_sides=np.array([stop.arc.tool_side for stop in stops]),
        branches=np.array([stop.arc.branch for stop in stops]),
        paths=paths,
        references=np.concatenate(([np.asarray(reference)], paths[:-1, 0])),
    )
    reports = [
        SolverReport(METHOD, 0.0, stop.candidate.iterations, stop.candidate.status)
        for stop in stops
    ]
    planned = judge_many(problem, proposed, reports)
    # Behind one that fails, efforts would count from a posture where nobody stands.
    held = next((k for k, target in enumerate(targets) if target.id not in planned), len(targets))
    return {target.id: planned[target.id] for target in targets[:held]}


def plan_many(problem: Problem, targets: Sequence[Target]) -> dict[str, Approach]:
    """Planned and verified approaches by target id; targets that need a closer look are left out.

    Args:
        problem: one that `plans_together` accepts, of independent targets.
        targets: some of its targets.
    """
    planned: dict[str, Approach] = {}
    exact = [target for target in targets if not target.position_std_m]
    for first in range(0, len(exact), BATCH_PART):
        part = exact[first : first + BATCH_PART]
        started = time.perf_counter()
        proposed, refined = _proposed(problem, part)
        elapsed_s = (time.perf_counter() - started) / len(part)
        reports = [SolverReport(METHOD, elapsed_s, cells, "optimum_of_arcs") for cells in refined]
        planned |= judge_many(problem, proposed, reports)
    return planned


def _proposed(problem: Problem, targets: Sequence[Target]) -> tuple[ProposedPaths, list[int]]:
    """Approaches of the targets that have one, and how many cells each took."""
    positions, directions = _vectors(targets)
    optima = closed_form_optima(problem, positions, directions, np.asarray(problem.start))
    leaves = _leave_between_rows(problem, positions, directions, optima)
    kept = np.flatnonzero((optima.branches != NO_BRANCH) & ~leaves)
    proposed = ProposedPaths(
        target_ids=[targets[k].id for k in kept.tolist()],
        positions=positions[kept],
        directions=directions[kept],
        angles_rad=np.array([signed_angle(angle) for angle in optima.angles_rad[kept].tolist()]),
        tool_sides=optima.tool_sides[kept],
        branches=optima.branches[kept],
        paths=optima.paths[kept],
        references=np.broadcast_to(np.asarray(problem.start), (len(kept), 6)),
    )
    return proposed, optima.refined[kept].tolist()


def _leave_between_rows(
    problem: Problem, positions: Array, directions: Array, optima: Optima
) -> NDArray[np.bool_]:
    """Whether a cut-in may be infeasible between what is looked at, on a second look too, (n,)."""
    leaves = optima.suspicious.copy()
    again = np.flatnonzero(leaves)
    if len(again):
        leaves[again] = finer_paths(problem, positions, directions, optima, again).suspicious
    return leaves


def _vectors(targets: Sequence[Target]) -> tuple[Array, Array]:
    """Positions [m] and branch directions, shape (n, 3) each."""
    positions = np.array([target.position_m for target in targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in targets], dtype=np.float64)
    return positions, directions
