"""IPOPT on a programme of the task definition."""

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from solver.methods.nlp.formulation import Shape, build_programme
from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.nlp.tolerances import NLP_BARRIER, NLP_BOUND_PUSH, NLP_TOLERANCE
from solver.robots.model import Robot
from solver.tolerances import NLP_ITERATIONS


def ipopt_options(*, tolerance: float, barrier: float, iterations: int) -> dict[str, Any]:
    """What `casadi.nlpsol` is told: silent, and bounds as they are, from a start near an optimum.

    Args:
        tolerance: overall error, in the programme's units.
        barrier: the first barrier parameter, in units of the cost.
        iterations: the most.
    """
    return {
        "print_time": False,
        "error_on_fail": False,
        "calc_lam_p": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": tolerance,
            "max_iter": iterations,
            "mu_init": barrier,
            "bound_push": NLP_BOUND_PUSH,
            "bound_frac": NLP_BOUND_PUSH,
            "bound_relax_factor": 0.0,
        },
    }


@lru_cache(maxsize=64)
def _solver(robot: Robot, shape: Shape, iterations: int) -> Any:
    """IPOPT on a robot's programme, built once in a process."""
    options = ipopt_options(tolerance=NLP_TOLERANCE, barrier=NLP_BARRIER, iterations=iterations)
    return ca.nlpsol("task_definition", "ipopt", build_programme(robot, shape).nlp, options)


def solve_by_ipopt(robot: Robot, instance: Instance) -> ProgrammeResult:
    """Solves a programme; `status` is IPOPT's own word."""
    solver = _solver(robot, instance.programme.shape, NLP_ITERATIONS)
    lower, upper = instance.constraint_bounds
    try:
        answer = solver(
            x0=instance.x0,
            p=instance.parameters,
            lbx=instance.lower,
            ubx=instance.upper,
            lbg=lower,
            ubg=upper,
        )
    except RuntimeError as error:
        # CasADi raises what it cannot even begin with; the caller falls back on its warm start.
        what = str(error).partition("\n")[0]
        return ProgrammeResult(False, f"error: {what}", 0, instance.x0)
    stats = solver.stats()
    return ProgrammeResult(
        bool(stats["success"]),
        str(stats["return_status"]),
        int(stats["iter_count"]),
        np.array(answer["x"]).ravel(),
    )
