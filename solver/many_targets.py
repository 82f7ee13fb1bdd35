"""Many targets planned together, without a loop in Python: independent ones without timed motion.

What cannot be vouched for here is left to `solver.one_target`: a batch only ever saves time.
"""

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.approach.batch import NO_BRANCH, Optima, closed_form_optima, finer_paths
from solver.approach.between_rows import many_may_leave_between
from solver.approach.frame import signed_angle
from solver.kinematics.families import has_closed_form, rail_of
from solver.many_verification import ProposedPaths, judge_many
from solver.problem import Problem, Target
from solver.robots.model import Array
from solver.solution import Approach, SolverReport
from solver.tolerances import BATCH_PART, LEAST_REFINED_ROWS

METHOD = "ssas"


def plans_together(problem: Problem) -> bool:
    """Whether targets of a problem can be planned together."""
    options = problem.options
    return (
        options.method == METHOD
        and options.order == "independent"
        and not options.timed
        and not options.certify
        and "arcs" not in (options.include or ())
        and options.path_points >= LEAST_REFINED_ROWS
        and has_closed_form(problem.robot, problem.mounted_tool)
        and rail_of(problem.robot, problem.mounted_tool) is None
    )


def plan_many(problem: Problem, targets: Sequence[Target]) -> dict[str, Approach]:
    """Planned and verified approaches by target id; targets that need a closer look are left out.

    Args:
        problem: one that `plans_together` accepts.
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
    positions = np.array([target.position_m for target in targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in targets], dtype=np.float64)
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
    )
    return proposed, optima.refined[kept].tolist()


def _leave_between_rows(
    problem: Problem, positions: Array, directions: Array, optima: Optima
) -> NDArray[np.bool_]:
    """Whether a joint may leave its limits between two rows, shape (n,), on a second look too."""
    leaves = np.empty(len(positions), dtype=np.bool_)
    margin = problem.options.limit_margin_rad
    lower, upper = problem.robot.lower + margin, problem.robot.upper - margin
    many_may_leave_between(optima.paths, lower, upper, leaves)
    again = np.flatnonzero(leaves & (optima.branches != NO_BRANCH))
    if len(again):
        leaves[again] = finer_paths(problem, positions, directions, optima, again).suspicious
    return leaves
