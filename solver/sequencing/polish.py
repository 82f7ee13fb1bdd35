"""Kernels: the angles of a chain, refined together and continuously.

A grid cannot follow a kink of the l1 norm that ties the angles of neighbouring targets together,
nor can moving one angle after the other. So all move at once. Around the present angles every
posture is replaced by its parabola in the angle; the chain's effort in these parabolas, the l1 norm
rounded off within mu, is minimised by Newton's method, whose Hessian is tridiagonal, with mu
falling to nothing; the minimum is taken over when the true effort is lower there. Where the
parabolas were wrong, the angles may move less far. They stay on their arcs throughout.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import kernel
from solver.problem.effort import joint_cost
from solver.sequencing.batch import arc_postures
from solver.sequencing.tolerances import (
    CHAIN_DAMPING,
    CHAIN_DAMPING_RELATIVE,
    CHAIN_GAIN_RELATIVE,
    CHAIN_HALVINGS,
    CHAIN_MU_FACTOR,
    CHAIN_MU_LEAST,
    CHAIN_NEWTON_STEPS,
    CHAIN_REACH_RAD,
    CHAIN_ROUNDING_RELATIVE,
    CHAIN_ROUNDS,
    CHAIN_STENCIL_RAD,
    CHAIN_STILL_RAD,
    CHAIN_WORTH_MU,
)


@kernel
def polished(batch, arcs, angles):
    """Angles of a chain, moved to a local minimum of its effort, and that effort.

    Args:
        batch: the targets.
        arcs: the arc of each approach of the chain, shape (n,).
        angles: where to begin, shape (n,) [rad].
    """
    n = len(arcs)
    # By coefficient, joint and target; a target's `before` is what the chain comes from.
    thinning, before = np.empty((3, 6, n)), np.zeros((3, 6, n))
    before[0, :, 0] = batch.start
    best = angles.copy()
    stages, tried_stages, model_stages = np.empty(n), np.empty(n), np.empty(n)
    _stage_efforts(batch, arcs, best, stages)
    reach, last = np.full(n, CHAIN_REACH_RAD), np.empty((3, 6, 1))[:, :, 0]
    moved = np.ones(n, dtype=np.bool_)
    width = CHAIN_REACH_RAD
    for _ in range(CHAIN_ROUNDS):
        for k in range(n):
            if moved[k]:
                behind = before[:, :, k + 1] if k + 1 < n else last
                _parabolas(batch, arcs[k], best[k], thinning[:, :, k], behind)
        step = _model_minimum(batch, arcs, best, thinning, before, reach, width)
        width = max(np.abs(step).max(), CHAIN_MU_LEAST)
        _model_efforts(thinning, before, step, batch.squared, 0.0, model_stages)
        tried = best + step
        for k in range(n):
            tried[k] = min(max(tried[k], batch.arc_lower[arcs[k]]), batch.arc_upper[arcs[k]])
        _stage_efforts(batch, arcs, tried, tried_stages)
        cost = stages.sum()
        expected, gain = cost - model_stages.sum(), cost - tried_stages.sum()
        errors = np.abs(tried_stages - model_stages)
        _adapt_reach(reach, errors, expected / (2 * n), gain < expected / 2)
        moved[:] = False
        if gain > 0:
            moved[:] = tried != best
            best, stages[:] = tried, tried_stages
        if expected <= CHAIN_GAIN_RELATIVE * cost:
            break
    return best, stages.sum()


@kernel
def _adapt_reach(reach, errors, allowed, shorter):
    """The reach of each angle, after the errors of the parabolas at the stages it takes part in."""
    n = len(reach)
    for k in range(n):
        error = max(errors[k], errors[k + 1] if k + 1 < n else 0.0)
        if error <= allowed:
            reach[k] = min(reach[k] * 2, CHAIN_REACH_RAD)
        elif shorter:
            reach[k] = max(reach[k] / 4, CHAIN_STILL_RAD)


@kernel
def _stage_efforts(batch, arcs, angles, stages):
    """Writes the effort of reaching each approach of a chain."""
    n = len(arcs)
    thinning, standby = np.empty((6, n)), np.empty((6, n))
    arc_postures(batch, arcs, angles, thinning, standby)
    for k in range(n):
        stages[k] = 0.0
        for i in range(6):
            before = standby[i, k - 1] if k > 0 else batch.start[i]
            stages[k] += joint_cost(thinning[i, k] - before, batch.squared)


@kernel
def _parabolas(batch, arc, angle, thinning, standby):
    """Values, slopes and halves of the curvatures of both postures, shape (3, 6) each.

    The three angles they come from are on the arc: beyond it joints may jump or the reach end.
    """
    lower, upper = batch.arc_lower[arc], batch.arc_upper[arc]
    e = min(CHAIN_STENCIL_RAD, (upper - lower) / 2)
    middle = min(max(angle, lower + e), upper - e)
    angles = np.array([angle, middle - e, middle, middle + e])
    points, ends = np.empty((6, 4)), np.empty((6, 4))
    arc_postures(batch, np.full(4, arc), angles, points, ends)
    for i in range(6):
        _parabola(points[i], e, angle - middle, thinning[:, i])
        _parabola(ends[i], e, angle - middle, standby[:, i])


@kernel
def _parabola(values, e, off, coefficients):
    """The parabola at a place that is `off` the middle of three, from the values there, e apart."""
    coefficients[0], coefficients[1], coefficients[2] = values[0], 0.0, 0.0
    if e > 0.0:
        half = (values[3] - 2 * values[2] + values[1]) / (2 * e * e)
        coefficients[1] = (values[3] - values[1]) / (2 * e) + 2 * half * off
        coefficients[2] = half


@kernel
def _model_efforts(thinning, before, x, squared, mu, stages):
    """Writes the effort of reaching each approach in the parabolas; returns the sum."""
    y = _shifted(x)
    stages[:] = 0.0
    for i in range(6):
        t0, t1, t2 = thinning[0, i], thinning[1, i], thinning[2, i]
        b0, b1, b2 = before[0, i], before[1, i], before[2, i]
        for k in range(len(x)):
            r = t0[k] + x[k] * (t1[k] + x[k] * t2[k]) - (b0[k] + y[k] * (b1[k] + y[k] * b2[k]))
            stages[k] += r * r if squared else math.sqrt(max(r * r + mu * mu, 0.0))
    return stages.sum()


@kernel
def _shifted(x):
    """Of each approach, the change of the angle before it; none before the first."""
    y = np.zeros(len(x))
    y[1:] = x[:-1]
    return y


@kernel
def _model_minimum(batch, arcs, angles, thinning, before, reach, width):
    """Changes of the angles that minimise the effort in the parabolas, within the reach [rad].

    The l1 norm is rounded off within `width` at first.
    """
    n = len(arcs)
    low, high = np.empty(n), np.empty(n)
    for k in range(n):
        low[k] = max(batch.arc_lower[arcs[k]] - angles[k], -reach[k])
        high[k] = min(batch.arc_upper[arcs[k]] - angles[k], reach[k])
    x, dual = np.zeros(n), np.zeros((6, n))
    squared = batch.squared
    mu = width
    while True:
        for _ in range(CHAIN_NEWTON_STEPS):
            if not _newton_step(thinning, before, x, dual, low, high, squared, mu):
                break
        if squared or mu <= CHAIN_MU_LEAST:
            return x
        mu *= CHAIN_MU_FACTOR


@kernel
def _newton_step(thinning, before, x, dual, low, high, squared, mu):
    """One projected Newton step of the model, taken in place; false when it gains nothing.

    With l1 it is a primal-dual step (Chan, Golub, Mulet, SIAM J. Sci. Comput. 20, 1999): `dual`,
    shape (6, n), within +-1, stands for r / sqrt(r^2 + mu^2), whose own slope misleads Newton's
    method as mu falls.
    """
    n, y = len(x), _shifted(x)
    slope, middle, beside = np.zeros(n), np.zeros(n), np.zeros(n)
    slope_before, middle_before = np.zeros(n), np.zeros(n)
    heres, theres = np.empty((6, n)), np.empty((6, n))
    firsts, seconds = np.empty((6, n)), np.empty((6, n))
    for i in range(6):
        t0, t1, t2 = thinning[0, i], thinning[1, i], thinning[2, i]
        b0, b1, b2 = before[0, i], before[1, i], before[2, i]
        own = dual[i]
        for k in range(n):
            r = t0[k] + x[k] * (t1[k] + x[k] * t2[k]) - (b0[k] + y[k] * (b1[k] + y[k] * b2[k]))
            root = math.sqrt(max(r * r + mu * mu, 0.0))
            firsts[i, k] = 2 * r if squared else r / root
            seconds[i, k] = 2.0 if squared else (1.0 - own[k] * r / root) / root
        for k in range(n):
            here, there = t1[k] + 2 * x[k] * t2[k], b1[k] + 2 * y[k] * b2[k]
            first, second = firsts[i, k], seconds[i, k]
            heres[i, k], theres[i, k] = here, there
            slope[k] += first * here
            middle[k] += second * here * here + max(2 * first * t2[k], 0.0)
            slope_before[k] -= first * there
            middle_before[k] += second * there * there + max(-2 * first * b2[k], 0.0)
            beside[k] -= second * here * there
    slope[:-1] += slope_before[1:]
    middle[:-1] += middle_before[1:]
    for k in range(n):
        at_low, at_high = x[k] <= low[k] and slope[k] > 0, x[k] >= high[k] and slope[k] < 0
        if at_low or at_high:
            slope[k], middle[k], beside[k] = 0.0, 1.0, 0.0
            if k + 1 < n:
                beside[k + 1] = 0.0
        middle[k] = middle[k] * (1 + CHAIN_DAMPING_RELATIVE) + CHAIN_DAMPING
    _solve_tridiagonal(middle, beside, slope)
    stages = np.empty(n)
    at_first = _model_efforts(thinning, before, x, squared, mu, stages)
    share = 1.0
    for _ in range(CHAIN_HALVINGS):
        tried = np.minimum(np.maximum(x - share * slope, low), high)
        after = _model_efforts(thinning, before, tried, squared, mu, stages)
        if after < at_first:
            change = tried - x
            change_before = _shifted(change)
            for i in range(6):
                for k in range(n):
                    moved = heres[i, k] * change[k] - theres[i, k] * change_before[k]
                    moved = firsts[i, k] + seconds[i, k] * moved
                    dual[i, k] = min(max(moved, -1.0), 1.0)
            x[:] = tried
            worth = CHAIN_ROUNDING_RELATIVE * at_first if squared else CHAIN_WORTH_MU * mu
            return at_first - after > worth
        share /= 2
    return False


@kernel
def _solve_tridiagonal(middle, beside, right):
    """Solves in place, into `right`; symmetric, `beside[k]` is between k - 1 and k."""
    n = len(middle)
    for k in range(1, n):
        factor = beside[k] / middle[k - 1]
        middle[k] -= factor * beside[k]
        right[k] -= factor * right[k - 1]
    right[n - 1] /= middle[n - 1]
    for k in range(n - 2, -1, -1):
        right[k] = (right[k] - beside[k + 1] * right[k + 1]) / middle[k]
