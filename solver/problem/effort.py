"""Effort of reaching a posture: weighted joint travel (T 3.4.2, with the weights of T 5.2.2)."""

from collections.abc import Sequence

import numpy as np

from solver.robots.model import Array


def posture_effort(
    thinning: Array | Sequence[float],
    reference: Array | Sequence[float],
    joint_weights: Sequence[float],
    norm: str,
) -> float:
    """Sum of w |change| (norm "l1") or w change^2 ("l2") between two postures [rad or rad^2]."""
    change = np.abs(np.asarray(thinning) - np.asarray(reference))
    return float(np.dot(joint_weights, change if norm == "l1" else change**2))
