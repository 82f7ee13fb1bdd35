"""Kernels: where a search for the nearest displacement starts, from a grid over the whole turn.

With the approach angle, joint 1 and the tilt of the forearm (joints 2 and 3 together) given, the
orientation decides the wrist's joints, and the wrist centre lies on a circle about the shoulder, on
which joint 2 turns: its point nearest to where the target asks for it follows in closed form. So a
grid of three variables covers all approaches of all branches, with the branch direction kept.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.refusal.tolerances import (
    SEED_ANGLES,
    SEED_BINS,
    SEED_OUTSIDE_M,
    SEED_SPREAD,
    SEED_SPREAD_M,
    SEED_STRIDE,
    SEED_TILTS,
    SEED_WAISTS,
)
from solver.approach.task.feasibility import tool_axes
from solver.compiled import kernel
from solver.kinematics.arctangent import atan2
from solver.kinematics.spherical_wrist import wrap, wrist_turns

_STEP = 2 * math.pi / SEED_ANGLES


@kernel
def waists(task):
    """Cosine and sine of joint 1 over its limits, shape (SEED_WAISTS, 2)."""
    table = np.empty((SEED_WAISTS, 2))
    # A whole turn ends a step before it begins again.
    whole = 2 * math.pi * (1.0 - 1.0 / SEED_WAISTS)
    span = min(task.upper[0] - task.lower[0], whole)
    for i in range(SEED_WAISTS):
        turn = task.lower[0] + task.geometry.offsets[0] + span * i / (SEED_WAISTS - 1)
        table[i, 0], table[i, 1] = math.cos(turn), math.sin(turn)
    return table


@kernel
def tilts(task):
    """The forearm at some sums of theta2 and theta3, shape (SEED_TILTS, 9).

    Columns: cosine and sine of the sum; the forearm's end from the elbow, outward and up [m];
    cosine and sine of the least and the largest theta2 that the limits leave there; 1 where these
    are no more than half a turn apart.
    """
    g, table = task.geometry, np.empty((SEED_TILTS, 9))
    low2, high2 = task.lower[1] + g.offsets[1], task.upper[1] + g.offsets[1]
    low3, high3 = task.lower[2] + g.offsets[2], task.upper[2] + g.offsets[2]
    for j in range(SEED_TILTS):
        total = low2 + low3 + (high2 + high3 - low2 - low3) * (j + 0.5) / SEED_TILTS
        least, most = max(low2, total - high3), min(high2, total - low3)
        row = table[j]
        row[0], row[1] = math.cos(total), math.sin(total)
        row[2], row[3] = g.l3 * math.cos(total + g.beta), g.l3 * math.sin(total + g.beta)
        row[4], row[5], row[6], row[7] = (
            math.cos(least),
            math.sin(least),
            math.cos(most),
            math.sin(most),
        )
        row[8] = 1.0 * (most - least <= math.pi)
    return table


@kernel
def outside(task, q, first):
    """How far joints from `first` on are beyond their limits, added up [rad]."""
    total = 0.0
    for i in range(first, 6):
        total += max(task.lower[i] - q[i], q[i] - task.upper[i], 0.0)
    return total


@kernel
def seeds(task, needed, starts):
    """Where to start on each branch and in each part of the turn, and what that roughly needs.

    Args:
        task: the task.
        needed: written, shape (8, SEED_BINS): displacement of the best point of the grid, and what
            it is beyond limits of the wrist and of the standby posture as a length [m]; infinite
            where there is none, or where others need far less.
        starts: written, shape (8, SEED_BINS, 4): its displacement [m] and approach angle [rad].
    """
    g, p = task.geometry, task.position
    waist, tilt = waists(task), tilts(task)
    axes, q = np.empty((3, 3)), np.empty(6)
    needed[:] = math.inf
    most, long2, sign2 = math.inf, abs(g.a2), math.copysign(1.0, g.a2)
    standoff = task.retreats[0]
    for n in range(SEED_ANGLES):
        # In strides, so that what is far too far is soon known.
        k = n * SEED_STRIDE % SEED_ANGLES
        angle = -math.pi + _STEP * k
        tool_axes(task, angle, axes)
        x_axis, y_axis = (axes[0, 0], axes[1, 0], axes[2, 0]), (axes[0, 1], axes[1, 1], axes[2, 1])
        z_axis = (axes[0, 2], axes[1, 2], axes[2, 2])
        cx = p[0] - g.tool_length * z_axis[0]
        cy = p[1] - g.tool_length * z_axis[1]
        cz = p[2] - g.tool_length * z_axis[2]
        place_in_turn = k * SEED_BINS // SEED_ANGLES
        up = g.sign1 * (cz - g.d1)
        for i in range(SEED_WAISTS):
            cos1, sin1 = waist[i, 0], waist[i, 1]
            outward = cos1 * cx + sin1 * cy - g.a1
            beside = g.sign1 * g.shoulder - sin1 * cx + cos1 * cy
            if abs(beside) >= most:
                continue
            side = math.sqrt(most * most - beside * beside) if most < math.inf else math.inf
            nearest2, farthest2 = max(long2 - side, 0.0) ** 2, (long2 + side) ** 2
            for j in range(SEED_TILTS):
                # From the shoulder's axis to where the elbow is asked for.
                er, es = outward - tilt[j, 2], up - tilt[j, 3]
                square = er * er + es * es
                if not nearest2 < square < farthest2:
                    continue
                distance = math.sqrt(square)
                ar, az = sign2 * er, sign2 * es
                above = tilt[j, 4] * az - tilt[j, 5] * ar
                below = tilt[j, 7] * ar - tilt[j, 6] * az
                if above >= 0.0 and below >= 0.0 and tilt[j, 8] > 0.0:
                    cos2, sin2 = ar / distance, az / distance
                elif tilt[j, 4] * ar + tilt[j, 5] * az > tilt[j, 6] * ar + tilt[j, 7] * az:
                    cos2, sin2 = tilt[j, 4], tilt[j, 5]
                else:
                    cos2, sin2 = tilt[j, 6], tilt[j, 7]
                dr, ds = g.a2 * cos2 - er, g.a2 * sin2 - es
                length = math.sqrt(beside * beside + dr * dr + ds * ds)
                if length >= most:
                    continue
                # The wrist centre at standby, in the arm's plane and beside it.
                x = g.a1 + g.a2 * cos2 + tilt[j, 2]
                back_r = x - standoff * (cos1 * z_axis[0] + sin1 * z_axis[1])
                back_b = standoff * (cos1 * z_axis[1] - sin1 * z_axis[0]) + g.sign1 * g.shoulder
                back_s = g.a2 * sin2 + tilt[j, 3] - g.sign1 * standoff * z_axis[2]
                ahead = math.sqrt(max(back_r * back_r + back_b * back_b - g.shoulder**2, 0.0))
                ahead = math.copysign(ahead, x) - g.a1
                away = math.sqrt(ahead * ahead + back_s * back_s)
                length += max(away - long2 - g.l3, abs(long2 - g.l3) - away, 0.0)
                if length >= most:
                    continue
                r13, r23, cos5, r31, r32 = wrist_turns(
                    g, cos1, sin1, tilt[j, 0], tilt[j, 1], x_axis, y_axis, z_axis
                )
                theta4 = atan2(g.sign5 * r23, g.sign5 * r13)
                theta5 = atan2(math.sqrt(r13 * r13 + r23 * r23), cos5)
                theta6 = atan2(-g.sign4 * r32, g.sign4 * r31)
                folded = cos2 * tilt[j, 3] - sin2 * tilt[j, 2] < 0.0
                arm = 4 * (x < 0.0) + 2 * folded
                dx = cos1 * (x - outward - g.a1) + sin1 * beside
                dy = sin1 * (x - outward - g.a1) - cos1 * beside
                dz = g.sign1 * (g.a2 * sin2 + tilt[j, 3] - up)
                for wrist in range(2):
                    half, sign = math.pi * wrist, 1.0 - 2.0 * wrist
                    q[3] = g.middles[3] + wrap(theta4 + half - g.offsets[3] - g.middles[3])
                    q[4] = g.middles[4] + wrap(sign * theta5 - g.offsets[4] - g.middles[4])
                    q[5] = g.middles[5] + wrap(theta6 + half - g.offsets[5] - g.middles[5])
                    need = length + SEED_OUTSIDE_M * outside(task, q, 3)
                    branch = arm + wrist
                    if need >= min(needed[branch, place_in_turn], most):
                        continue
                    if need < needed[branch, place_in_turn]:
                        needed[branch, place_in_turn] = need
                        start = starts[branch, place_in_turn]
                        start[0], start[1], start[2], start[3] = dx, dy, dz, angle
                        most = min(most, SEED_SPREAD * need + SEED_SPREAD_M)
