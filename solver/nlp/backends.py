"""IPOPT on the task definition's programme, from a warm start."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from solver.approach.task import ApproachTask
from solver.methods.semi_analytic import ArcOptimum
from solver.nlp.formulation import Programme, build_programme
from solver.robots.model import Array, Robot
from solver.tolerances import NLP_BARRIER, NLP_BOUND_PUSH, NLP_ITERATIONS, NLP_TOLERANCE


@dataclass(frozen=True)
class ProgrammeResult:
    """What the backend ended with; nothing in it is verified."""

    success: bool
    status: str
    iterations: int
    approach_angle_rad: float
    thinning_joints: Array


@dataclass(frozen=True)
class _Solver:
    programme: Programme
    function: Any


@lru_cache(maxsize=16)
def _solver(robot: Robot, norm: str) -> _Solver:
    """IPOPT on a robot's programme, built once in a process."""
    programme = build_programme(robot, norm)
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "calc_lam_p": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": NLP_TOLERANCE,
            "max_iter": NLP_ITERATIONS,
            "mu_init": NLP_BARRIER,
            "bound_push": NLP_BOUND_PUSH,
            "bound_frac": NLP_BOUND_PUSH,
            "bound_relax_factor": 0.0,
        },
    }
    return _Solver(programme, ca.nlpsol("task_definition", "ipopt", programme.nlp, options))


@dataclass(frozen=True)
class ProgrammeStart:
    """Where the programme starts: both postures, shape (n,), the angle, and that angle's bounds."""

    standby: Array
    thinning: Array
    tool_side: int
    angle_rad: float
    lower_rad: float
    upper_rad: float


def solve_programme(task: ApproachTask, warm_start: ArcOptimum) -> ProgrammeResult:
    """Solves the task's programme from the closed form's optimum, on that optimum's arc."""
    arc, angle = warm_start.arc, warm_start.angle_rad
    ends = np.array([task.options.standoff_m, 0.0])
    standby, thinning = task.postures(angle, arc.tool_side, arc.branch, ends)
    return run_programme(
        task,
        ProgrammeStart(standby, thinning, arc.tool_side, angle, arc.lower_rad, arc.upper_rad),
    )


def run_programme(task: ApproachTask, start: ProgrammeStart) -> ProgrammeResult:
    """Solves the task's programme from a start, for any arm."""
    solver = _solver(task.robot, task.options.norm)
    standby, thinning = start.standby, start.thinning
    reference, slacks = np.asarray(task.reference), solver.programme.slacks
    frame = task.frame
    x0 = [thinning, standby, np.array([start.angle_rad])]
    lower = [task.lower, task.lower, np.array([start.lower_rad])]
    upper = [task.upper, task.upper, np.array([start.upper_rad])]
    if slacks:
        x0.append(np.abs(thinning - reference))
        lower.append(np.zeros(slacks))
        upper.append(np.full(slacks, np.inf))
    parameters = np.concatenate(
        [
            np.asarray(task.target.position_m, dtype=np.float64),
            start.tool_side * frame.branch,
            frame.outward,
            frame.sideways,
            reference,
            task.joint_weights,
            [task.options.standoff_m, task.tool.length_m],
        ]
    )
    equalities = solver.programme.equalities
    answer = solver.function(
        x0=np.concatenate(x0),
        p=parameters,
        lbx=np.concatenate(lower),
        ubx=np.concatenate(upper),
        lbg=np.zeros(equalities + 2 * slacks),
        ubg=np.concatenate([np.zeros(equalities), np.full(2 * slacks, np.inf)]),
    )
    stats = solver.function.stats()
    n = len(task.robot.joints)
    return ProgrammeResult(
        bool(stats["success"]),
        str(stats["return_status"]),
        int(stats["iter_count"]),
        float(answer["x"][2 * n]),
        np.asarray(answer["x"][:n]).ravel(),
    )
