"""The programme from random starts, without the closed form: what the warm start is worth."""

import math
import time
from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.methods.candidates import from_thinning
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import Start, make_instance, placed, shape_of
from solver.methods.nlp.whole_cut_in import pose_of, solve_whole_cut_in
from solver.problem.effort import posture_effort
from solver.problem.options import BackendName
from solver.problem.retreats import even_retreats
from solver.problem.solution import Reason
from solver.robots.model import Array
from solver.tolerances import AXIS_ERROR_RAD, LIMIT_EXCESS_RAD, POSITION_ERROR_M


class ColdResult(NamedTuple):
    """What a cold solve came to.

    Attributes:
        success: one of the starts led to postures that hold at thinning and standby.
        elapsed_s: time of all starts together, building the programme not counted [s].
        effort: the least effort of those that hold; infinity when none does.
    """

    success: bool
    elapsed_s: float
    effort: float


def cold_solve(task: ApproachTask, backend: BackendName, starts: int, seed: int) -> ColdResult:
    """Solves a task from seeded random starts, all of them, the best answer wins.

    Joints are drawn evenly within their limits, standby like thinning, the approach angle from the
    whole turn. Success is judged by forward kinematics: both postures where they have to be,
    and inside the limits. The cut-in between them is not looked at.

    Args:
        task: the target's task.
        backend: one of `solver.methods.nlp.backends.BACKENDS`.
        starts: how many starts.
        seed: of the random numbers.
    """
    options = replace(task.options, nlp_backend=backend)
    programme = build_programme(task.robot, shape_of(task))
    rng = np.random.default_rng(seed)
    # Building is done once in a process, so it is none of a solve's time.
    solve_instance(task.robot, make_instance(task, programme, _random_start(task, rng)), options)
    rng = np.random.default_rng(seed)
    best = math.inf
    began = time.perf_counter()
    for _ in range(starts):
        start = _random_start(task, rng)
        instance = make_instance(task, programme, start)
        result = solve_instance(task.robot, instance, options)
        if not result.success:
            continue
        postures = result.x[: programme.angle].reshape(programme.postures, programme.joints)
        pose = pose_of(task, start.tool_side, placed(task, programme, result.x))
        if _holds(task, pose, postures, start.retreats_m):
            effort = posture_effort(postures[0], task.reference, task.joint_weights, options.norm)
            best = min(best, effort)
    return ColdResult(math.isfinite(best), time.perf_counter() - began, best)


def solve_cold(task: ApproachTask, starts: int, seed: int) -> Candidate | Reason:
    """`ncos` without its warm start: the cheapest of what seeded random starts lead to.

    Starts are drawn as in `cold_solve`. Each goes on until the whole cut-in holds, and its answer
    is put on the closed form.

    Args:
        task: the target's task, of an arm with a closed form.
        starts: how many starts.
        seed: of the random numbers.
    """
    rng = np.random.default_rng(seed)
    iterations, endings = 0, Counter[str]()
    best: Candidate | None = None
    for _ in range(starts):
        answer = solve_whole_cut_in(task, _random_start(task, rng))
        iterations += answer.iterations
        endings[answer.status] += 1
        if answer.thinning is None:
            continue
        offer = from_thinning(task, answer.tool_side, answer.branch, answer.thinning)
        if best is None or offer.effort < best.effort:
            best = offer
    if best is None:
        told = ", ".join(f"{status} ({count})" for status, count in sorted(endings.items()))
        return Reason("solver_failed", f"none of {starts} random starts led to an approach: {told}")
    return replace(best, iterations=iterations, status=f"best_of_{starts}_random_starts")


def _random_start(task: ApproachTask, rng: np.random.Generator) -> Start:
    side = int(rng.choice(task.tool_sides))
    postures = np.tile(rng.uniform(task.lower, task.upper), (2, 1))
    angle = float(rng.uniform(-math.pi, math.pi))
    retreats = even_retreats(task.options, 2)[::-1]
    bounds = angle - math.pi, angle + math.pi
    return Start(side, angle, *bounds, postures, retreats, strike_m=0.0, swing_rad=np.zeros(3))


def _holds(task: ApproachTask, pose: Array, postures: Array, retreats: Array) -> bool:
    frames = forward_kinematics(task.robot, task.tool, postures)
    places = pose[:3, 3] - np.outer(retreats, pose[:3, 2])
    off = np.linalg.norm(frames[:, :3, 3] - places, axis=1).max()
    turned = np.linalg.norm(frames[:, :3, :3] - pose[:3, :3], axis=(1, 2)).max()
    beyond = np.maximum(task.lower - postures, postures - task.upper).max()
    return bool(off <= POSITION_ERROR_M and turned <= AXIS_ERROR_RAD and beyond <= LIMIT_EXCESS_RAD)
