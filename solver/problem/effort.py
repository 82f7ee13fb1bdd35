"""Effort of reaching a posture: weighted joint travel (T 3.4.2, with the weights of T 5.2.2).

Once for arrays and once for the inner loops of kernels; the verifier has a formula of its own.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

from collections.abc import Sequence

import numpy as np

from solver.compiled import inlined
from solver.robots.model import Array


def posture_effort(
    thinning: Array | Sequence[float],
    reference: Array | Sequence[float],
    joint_weights: Sequence[float],
    norm: str,
) -> float:
    """Sum of w |change| (norm "l1") or w change^2 ("l2") between two postures [rad or rad^2]."""
    change = np.asarray(thinning) - np.asarray(reference)
    return float(np.dot(joint_weights, joint_costs(change, norm)))


def joint_costs(change: Array, norm: str) -> Array:
    """|change| (norm "l1") or change^2 ("l2") of each joint, before its weight [rad or rad^2]."""
    return np.asarray(np.abs(change) if norm == "l1" else change**2)


def cost_scale(joint_weights: Array, norm: str) -> Array:
    """What joint travel is multiplied with so that its bare cost is the weighted one."""
    return joint_weights if norm == "l1" else np.sqrt(joint_weights)


@inlined
def joint_cost(change, squared):
    """|change|, or where the norm is l2 change^2, of one joint, before its weight."""
    return change * change if squared else abs(change)
