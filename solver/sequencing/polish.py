"""Kernels: the angles of a chain, refined together and continuously.

A grid cannot follow a kink of the l1 norm that ties the angles of neighbouring targets together,
nor can moving one angle after the other. So all move at once. Around the present angles every
posture is replaced by its parabola in the angle; the chain's effort in these parabolas, the l1 norm
rounded off within mu, is minimised by Newton's method, whose Hessian is tridiagonal, with mu
falling to nothing; the minimum is taken over when the true effort is lower there. Where the
parabolas were wrong, the angles may move less far. They stay on their arcs throughout.
"""

import math

import numpy as np

from solver.compiled import kernel
from solver.sequencing.batch import one_approach
from solver.tolerances import (
    CHAIN_GAIN_RELATIVE,
    CHAIN_MU_FACTOR,
    CHAIN_MU_LEAST,
    CHAIN_NEWTON_STEPS,
    CHAIN_REACH_RAD,
    CHAIN_ROUNDS,
    CHAIN_STENCIL_RAD,
    CHAIN_STILL_RAD,
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
    start = batch.scale * batch.task.reference
    thinning, standby = np.empty((n, 3, 6)), np.empty((n, 3, 6))
    scratch = np.empty((len(batch.task.retreats), 6))
    best = angles.copy()
    stages, tried_stages, model_stages = np.empty(n), np.empty(n), np.empty(n)
    _stage_efforts(batch, arcs, best, start, scratch, stages)
    reach = np.full(n, CHAIN_REACH_RAD)
    moved = np.ones(n, dtype=np.bool_)
    width = CHAIN_REACH_RAD
    for _ in range(CHAIN_ROUNDS):
        for k in range(n):
            if moved[k]:
                _parabolas(batch, arcs[k], best[k], scratch, thinning[k], standby[k])
        step = _model_minimum(batch, arcs, best, start, thinning, standby, reach, width)
        width = max(np.abs(step).max(), CHAIN_MU_LEAST)
        _model_efforts(thinning, standby, start, step, batch.task.squared, 0.0, model_stages)
        tried = best + step
        for k in range(n):
            tried[k] = min(max(tried[k], batch.arc_lower[arcs[k]]), batch.arc_upper[arcs[k]])
        _stage_efforts(batch, arcs, tried, start, scratch, tried_stages)
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
def _stage_efforts(batch, arcs, angles, start, scratch, stages):
    """Writes the effort of reaching each approach of a chain."""
    at_target, behind = np.empty(6), np.empty(6)
    before = start.copy()
    for k in range(len(arcs)):
        one_approach(batch, arcs[k], angles[k], scratch, at_target, behind)
        stages[k] = 0.0
        for i in range(6):
            change = abs(at_target[i] - before[i])
            stages[k] += change * change if batch.task.squared else change
            before[i] = behind[i]


@kernel
def _parabolas(batch, arc, angle, scratch, thinning, standby):
    """Values, slopes and halves of the curvatures of both postures, shape (3, 6) each.

    The three angles they come from are on the arc: beyond it joints may jump or the reach end.
    """
    lower, upper = batch.arc_lower[arc], batch.arc_upper[arc]
    e = min(CHAIN_STENCIL_RAD, (upper - lower) / 2)
    one_approach(batch, arc, angle, scratch, thinning[0], standby[0])
    thinning[1:], standby[1:] = 0.0, 0.0
    if e <= 0.0:
        return
    middle = min(max(angle, lower + e), upper - e)
    points, ends = np.empty((3, 6)), np.empty((3, 6))
    for j in range(3):
        one_approach(batch, arc, middle + (j - 1) * e, scratch, points[j], ends[j])
    for i in range(6):
        half = (points[2, i] - 2 * points[1, i] + points[0, i]) / (2 * e * e)
        thinning[1, i] = (points[2, i] - points[0, i]) / (2 * e) + 2 * half * (angle - middle)
        thinning[2, i] = half
        half = (ends[2, i] - 2 * ends[1, i] + ends[0, i]) / (2 * e * e)
        standby[1, i] = (ends[2, i] - ends[0, i]) / (2 * e) + 2 * half * (angle - middle)
        standby[2, i] = half


@kernel
def _model_efforts(thinning, standby, start, x, squared, mu, stages):
    """Writes the effort of reaching each approach in the parabolas; returns the sum."""
    for k in range(len(x)):
        stages[k] = 0.0
        for i in range(6):
            r = thinning[k, 0, i] + x[k] * (thinning[k, 1, i] + x[k] * thinning[k, 2, i])
            if k == 0:
                r -= start[i]
            else:
                y = x[k - 1]
                r -= standby[k - 1, 0, i] + y * (standby[k - 1, 1, i] + y * standby[k - 1, 2, i])
            stages[k] += r * r if squared else math.sqrt(r * r + mu * mu)
    return stages.sum()


@kernel
def _model_minimum(batch, arcs, angles, start, thinning, standby, reach, width):
    """Changes of the angles that minimise the effort in the parabolas, within the reach [rad].

    The l1 norm is rounded off within `width` at first.
    """
    n = len(arcs)
    low, high = np.empty(n), np.empty(n)
    for k in range(n):
        low[k] = max(batch.arc_lower[arcs[k]] - angles[k], -reach[k])
        high[k] = min(batch.arc_upper[arcs[k]] - angles[k], reach[k])
    x, dual = np.zeros(n), np.zeros((n, 6))
    squared = batch.task.squared
    mu = width
    while True:
        for _ in range(CHAIN_NEWTON_STEPS):
            if not _newton_step(thinning, standby, start, x, dual, low, high, squared, mu):
                break
        if squared or mu <= CHAIN_MU_LEAST:
            return x
        mu *= CHAIN_MU_FACTOR


@kernel
def _newton_step(thinning, standby, start, x, dual, low, high, squared, mu):
    """One projected Newton step of the model, taken in place; false when it gains nothing.

    With l1 it is a primal-dual step (Chan, Golub, Mulet, SIAM J. Sci. Comput. 20, 1999): `dual`,
    shape (n, 6), within +-1, stands for r / sqrt(r^2 + mu^2), whose own slope misleads Newton's
    method as mu falls.
    """
    n = len(x)
    slope, middle, beside = np.zeros(n), np.zeros(n), np.zeros(n)
    heres, theres = np.zeros((n, 6)), np.zeros((n, 6))
    firsts, seconds = np.empty((n, 6)), np.empty((n, 6))
    for k in range(n):
        y = x[k - 1] if k > 0 else 0.0
        for i in range(6):
            r = thinning[k, 0, i] + x[k] * (thinning[k, 1, i] + x[k] * thinning[k, 2, i])
            here = thinning[k, 1, i] + 2 * x[k] * thinning[k, 2, i]
            there = 0.0
            if k == 0:
                r -= start[i]
            else:
                r -= standby[k - 1, 0, i] + y * (standby[k - 1, 1, i] + y * standby[k - 1, 2, i])
                there = standby[k - 1, 1, i] + 2 * y * standby[k - 1, 2, i]
            if squared:
                first, second = 2 * r, 2.0
            else:
                root = math.sqrt(r * r + mu * mu)
                first, second = r / root, (1.0 - dual[k, i] * r / root) / root
            heres[k, i], theres[k, i] = here, there
            firsts[k, i], seconds[k, i] = first, second
            slope[k] += first * here
            middle[k] += second * here * here + max(2 * first * thinning[k, 2, i], 0.0)
            if k > 0:
                slope[k - 1] -= first * there
                middle[k - 1] += second * there * there
                middle[k - 1] += max(-2 * first * standby[k - 1, 2, i], 0.0)
                beside[k] -= second * here * there
    for k in range(n):
        at_low, at_high = x[k] <= low[k] and slope[k] > 0, x[k] >= high[k] and slope[k] < 0
        if at_low or at_high:
            slope[k], middle[k], beside[k] = 0.0, 1.0, 0.0
            if k + 1 < n:
                beside[k + 1] = 0.0
        middle[k] = middle[k] * (1 + 1e-12) + 1e-9
    _solve_tridiagonal(middle, beside, slope)
    stages = np.empty(n)
    before = _model_efforts(thinning, standby, start, x, squared, mu, stages)
    share = 1.0
    for _ in range(20):
        tried = x - share * slope
        for k in range(n):
            tried[k] = min(max(tried[k], low[k]), high[k])
        after = _model_efforts(thinning, standby, start, tried, squared, mu, stages)
        if after < before:
            for k in range(n):
                behind = tried[k - 1] - x[k - 1] if k > 0 else 0.0
                for i in range(6):
                    change = heres[k, i] * (tried[k] - x[k]) - theres[k, i] * behind
                    moved = firsts[k, i] + seconds[k, i] * change
                    dual[k, i] = min(max(moved, -1.0), 1.0)
            x[:] = tried
            return before - after > (1e-13 * before if squared else 0.1 * mu)
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
