"""Closed-form methods on every arm: as they are, over a rail's positions, or not applicable."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.kinematics.families.registry import family_of
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.problem.solution import Reason

Solve = Callable[[ApproachTask], Candidate | Reason]

# How far a target came before it was refused; the furthest of a rail's positions explains it.
_STAGES: Final = ("out_of_reach", "joint_limit", "standby_infeasible", "cut_in_infeasible")


def on_any_arm(solve: Solve) -> Solve:
    """The method for every arm, from the one for a spherical wrist without a rail."""

    def solve_task(task: ApproachTask) -> Candidate | Reason:
        family = family_of(task.robot, task.tool)
        if family.has_closed_form:
            return solve(task)
        rail = family.rail_of(task.robot)
        return not_applicable(task) if rail is None else over_rail(task, rail, solve)

    return solve_task


def over_rail(task: ApproachTask, rail: Rail, solve: Solve) -> Candidate | Reason:
    """The best over the positions of `rail_positions`, each solved as an arm that stands there.

    Exact at each position and not optimal in the rail; ties go to the position that is nearer.
    """
    best: Candidate | None = None
    reasons: list[Reason] = []
    iterations = 0
    for position in rail_positions(task):
        travel = rail_effort(task, float(position))
        if best is not None and travel >= best.effort:
            break  # the arm's own part is not below zero, and from here the slide travels further
        outcome = solve(at_rail(task, rail, float(position)))
        if isinstance(outcome, Reason):
            reasons.append(outcome)
            continue
        iterations += outcome.iterations
        if best is None or outcome.effort + travel < best.effort:
            best = replace(
                outcome,
                thinning_joints=(float(position), *outcome.thinning_joints),
                effort=outcome.effort + travel,
            )
    return replace(best, iterations=iterations) if best is not None else _furthest(reasons)


def not_applicable(task: ApproachTask) -> Reason:
    """The reason for an arm without a closed form."""
    return Reason(
        "method_not_applicable",
        f"{task.options.method} needs the closed form of a spherical wrist, which "
        f"{task.robot.name} does not have; ncos starts from a numerical inverse instead",
    )


def _furthest(reasons: list[Reason]) -> Reason:
    def rank(reason: Reason) -> tuple[int, float]:
        stage = _STAGES.index(reason.code) if reason.code in _STAGES else -1
        margins = (reason.margin_rad, reason.margin_m)
        return stage, max((margin for margin in margins if margin is not None), default=0.0)

    reason = max(reasons, key=rank)
    return replace(reason, detail=f"at every position of the rail; at the best one {reason.detail}")
