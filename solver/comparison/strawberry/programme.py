"""`ncos`: problem P2 (S 3.3) in CasADi, solved by IPOPT.

Variables    q = s10, s21, s32, theta, beta          [m, rad]
Parameters   target, l1, l2, l3, d_x, d_y, d_z, reset of the slides, mu W, (m2 + m3) g, m3 g
Minimise     J(q), `index.py` [J]                    (S 37)
Subject to   tip(q) = target                         (S 2 to 4)
             limits of every joint

The programme is built once in a process and fed numbers, so every mechanism shares it.
"""

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from solver.comparison.strawberry.analytic import outside_box
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import Mechanism, Point, Posture, posture_at
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.tolerances import (
    INDEX_ROUNDING_J,
    MECHANISM_NLP_BARRIER,
    MECHANISM_NLP_TOLERANCE,
)
from solver.methods.nlp.ipopt import ipopt_options
from solver.problem.solution import Reason
from solver.robots.model import Array
from solver.tolerances import NLP_ITERATIONS


def solve_ncos_cold(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """P2 from the paper's own start, the reset.

    Returns:
        The posture of a local minimum, not necessarily the least one; `out_of_reach` outside the
        box of targets, `solver_failed` with IPOPT's own word otherwise.
    """
    if (reason := outside_box(mechanism, target)) is not None:
        return reason
    return solve_programme(mechanism, target, mechanism.reset)


def solve_ncos(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """P2 from `ssas`'s posture, or from the reset where `ssas` has none.

    Returns:
        The programme's local minimum, or its start where that is better: never a worse index than
        `ssas`, to INDEX_ROUNDING_J.
    """
    start = solve_ssas(mechanism, target)
    if isinstance(start, Reason):
        return solve_ncos_cold(mechanism, target)
    found = solve_programme(mechanism, target, start.posture)
    if isinstance(found, Reason) or found.index_j > start.index_j + INDEX_ROUNDING_J:
        spent = 0 if isinstance(found, Reason) else found.iterations
        return Answer(start.posture, start.index_j, spent, "kept its start")
    return found


def solve_programme(mechanism: Mechanism, target: Point, start: Posture) -> Answer | Reason:
    """P2 from a start.

    Args:
        mechanism: the mechanism.
        target: where the tip shall be [m].
        start: a posture inside the limits; it need not be at the target.

    Returns:
        The local minimum. Where the slides that belong to its angles are inside the limits they
        replace the programme's, which end some 1e-10 m beside its equations.
    """
    lower, upper = zip(*mechanism.limits, strict=True)
    solver = _solver()
    try:
        answer = solver(
            x0=start, p=_parameters(mechanism, target), lbx=lower, ubx=upper, lbg=0.0, ubg=0.0
        )
    except RuntimeError as error:
        # CasADi raises what it cannot even begin with.
        return Reason("solver_failed", f"error: {str(error).partition(chr(10))[0]}")
    stats = solver.stats()
    if not stats["success"]:
        return Reason("solver_failed", f"IPOPT: {stats['return_status']}")
    posture = Posture(*map(float, answer["x"].full().ravel()))
    exact = posture_at(mechanism, target, posture.theta_rad, posture.beta_rad)
    if all(a <= value <= b for value, (a, b) in zip(exact, mechanism.limits, strict=True)):
        posture = exact
    return Answer(
        posture, energy_index(mechanism, posture), int(stats["iter_count"]), stats["return_status"]
    )


def _parameters(mechanism: Mechanism, target: Point) -> Array:
    m = mechanism
    lengths = (m.l1_m, m.l2_m, m.l3_m, m.d_x_m, m.d_y_m, m.d_z_m)
    forces = (m.friction_n, m.lifted_n, m.tip_weight_n)
    return np.array((*target, *lengths, *m.reset[:3], *forces))


@lru_cache(maxsize=1)
def _solver() -> Any:
    q = ca.SX.sym("q", 5)
    s10, s21, s32, theta, beta = ca.vertsplit(q)
    p = ca.SX.sym("p", 15)
    x, y, z, l1, l2, l3, d_x, d_y, d_z, s10_0, s21_0, s32_0, friction, lifted, tip = ca.vertsplit(p)

    reach = l2 + l3 * ca.cos(beta)
    at = ca.vertcat(
        s21 + d_x - reach * ca.sin(theta),
        s10 + l1 - d_y + l3 * ca.sin(beta),
        -s32 + d_z - reach * ca.cos(theta),
    )
    lost = friction * (s10 - s10_0 + s21 - s21_0 + s32 - s32_0)
    rise = (
        lifted * (s32_0 - s32)
        + (lifted + tip) / 2 * l2 * (1 - ca.cos(theta))
        + tip * l3 / 2 * (1 - ca.cos(beta) * ca.cos(theta))
    )
    programme = {"x": q, "p": p, "f": lost - rise, "g": at - ca.vertcat(x, y, z)}
    options = ipopt_options(
        tolerance=MECHANISM_NLP_TOLERANCE,
        barrier=MECHANISM_NLP_BARRIER,
        iterations=NLP_ITERATIONS,
    )
    return ca.nlpsol("strawberry", "ipopt", programme, options)
