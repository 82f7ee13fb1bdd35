"""The quadratic programmes inside the sequential method, solved through qpsolvers."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from solver.methods.nlp.tolerances import (
    OSQP_ITERATIONS,
    OSQP_STEP,
    OSQP_TOLERANCE,
    PIQP_ROOM,
    QP_TOLERANCE,
)
from solver.robots.model import Array

QP_SOLVERS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "daqp": {"primal_tol": QP_TOLERANCE, "dual_tol": QP_TOLERANCE},
        "osqp": {
            "eps_abs": OSQP_TOLERANCE,
            "eps_rel": OSQP_TOLERANCE,
            "max_iter": OSQP_ITERATIONS,
            "rho": OSQP_STEP,
            "polishing": True,
        },
        "piqp": {"eps_abs": QP_TOLERANCE, "eps_rel": QP_TOLERANCE, "backend": "dense"},
    }
)
"""Each with its settings; the tolerances are absolute, as the programme is scaled near one."""


@dataclass(frozen=True)
class QuadraticAnswer:
    """Minimiser and multipliers of G x <= h (not negative), or why there is none."""

    found: bool
    x: Array
    z: Array
    detail: str = ""


def solve_quadratic(
    hessian: Array, gradient: Array, g: Array, h: Array, solver: str
) -> QuadraticAnswer:
    """Minimises x' hessian x / 2 + gradient' x subject to g x <= h.

    Args:
        hessian: symmetric, positive definite, shape (n, n).
        gradient: shape (n,).
        g: shape (m, n).
        h: shape (m,).
        solver: one of QP_SOLVERS.

    Returns:
        The answer; errors of the solver are its `detail`.
    """
    # A quarter of a second at the start of every process, most of which solve nothing.
    import qpsolvers
    from qpsolvers.exceptions import QPError
    from scipy.sparse import csc_matrix

    sparse = solver == "osqp"  # it knows no other matrices, and warns when it has to convert
    if solver == "piqp":
        h = np.where((h >= 0) & (h < PIQP_ROOM), PIQP_ROOM, h)
    problem = qpsolvers.Problem(
        csc_matrix(hessian) if sparse else hessian, gradient, csc_matrix(g) if sparse else g, h
    )
    try:
        with warnings.catch_warnings():
            # qpsolvers warns where a solver ends without an answer; `found` says so.
            warnings.simplefilter("ignore")
            solution = qpsolvers.solve_problem(problem, solver, **QP_SOLVERS[solver])
    except (QPError, ValueError, ArithmeticError) as error:
        return _none(gradient, h, f"{solver}: {error}")
    if not solution.found or solution.x is None or solution.z is None:
        return _none(gradient, h, f"{solver} found no minimiser")
    if not (np.isfinite(solution.x).all() and np.isfinite(solution.z).all()):
        return _none(gradient, h, f"{solver} returned numbers that are not finite")
    return QuadraticAnswer(True, solution.x, solution.z)


def _none(gradient: Array, h: Array, detail: str) -> QuadraticAnswer:
    return QuadraticAnswer(False, np.zeros_like(gradient), np.zeros_like(h), detail)
