"""Timed motion for approaches that were chosen before, built and verified anew.

A stored plan need not carry trajectories, its transfers may all begin at the start posture, and
what moves an arm is verified right before. Approach angles and branches stay as they were chosen;
everything else follows from them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.approach.cut_in.cut_in import build_cut_in
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task
from solver.exceptions import RetimingFailed
from solver.kinematics.families.registry import family_of
from solver.problem.problem import Problem
from solver.problem.solution import PLANNED, Approach, SolverReport
from solver.problem.targets import Target
from solver.robots.model import Array
from solver.solving.proposal import judged, propose
from solver.tolerances import SAME_POSTURE_RAD

BRANCHES = range(8)
MOTION = ("path", "transfer", "trajectory")


@dataclass(frozen=True)
class ChosenApproach:
    """What was chosen for one target; an arm without a closed form has no branch [rad or m]."""

    target_id: str
    approach_angle_rad: float
    tool_side: int
    branch: int | None
    standby_joints: Sequence[float]
    thinning_joints: Sequence[float]


def retime(problem: Problem, chosen: Sequence[ChosenApproach]) -> tuple[Approach, ...]:
    """Planned approaches with one continuous motion through them, in the order given.

    Raises:
        RetimingFailed: one does not verify, or has other postures than it had.
    """
    # Whatever the plan's answer left out, what moves is timed.
    problem = replace(problem, options=replace(problem.options, include=MOTION))
    targets = problem.targets_by_id
    reference: Sequence[float] = problem.start
    approaches: list[Approach] = []
    for choice in chosen:
        if choice.target_id not in targets:
            raise RetimingFailed(choice.target_id, "is no target of the problem")
        approach = _retimed(problem, targets[choice.target_id], choice, reference)
        approaches.append(approach)
        assert approach.standby_joints is not None, "the verifier wants it"
        reference = tuple(float(value) for value in approach.standby_joints)
    return tuple(approaches)


def _retimed(
    problem: Problem, target: Target, choice: ChosenApproach, reference: Sequence[float]
) -> Approach:
    # A joint that can turn further than once stays on the turn that was chosen.
    task = approach_task(problem, target, choice.thinning_joints)
    family = family_of(problem.robot, problem.mounted_tool)
    branches = BRANCHES if family.has_branches else (None,)
    known = choice.branch in branches and choice.tool_side in task.tool_sides
    if not known or len(choice.thinning_joints) != len(problem.robot.joints):
        raise RetimingFailed(target.id, "is on no branch or side of this arm and tool")
    if not np.all(np.isfinite(choice.thinning_joints)):
        raise RetimingFailed(target.id, "has a thinning posture that is not a number")
    candidate = Candidate(
        choice.approach_angle_rad,
        choice.tool_side,
        choice.branch,
        choice.thinning_joints,
        0.0,
        0,
        PLANNED,
    )
    report = SolverReport(problem.options.method, 0.0, 0, PLANNED)
    cut_in = build_cut_in(task, candidate)
    if not _same(choice.standby_joints, cut_in.path_joints[0]):
        raise RetimingFailed(target.id, "has another standby posture than it had")
    approach = judged(
        problem, propose(problem, target, candidate, cut_in, reference, report), reference
    )
    if approach.reason is not None:
        raise RetimingFailed(target.id, approach.reason.detail)
    return approach


def _same(was: Sequence[float], now: Array) -> bool:
    # Written so that a posture that is not a number is another one.
    return len(was) == len(now) and bool(np.all(np.abs(np.asarray(was) - now) <= SAME_POSTURE_RAD))
