"""The performance index J of all three methods: energy from the reset to a posture.

    J = friction + potential
    friction  = mu W [(s10 - s10,0) + (s21 - s21,0) + (s32 - s32,0)]                       (S 22)
    potential = (m2 + m3) g (s32 - s32,0) - (m2 / 2 + m3) g l2 (1 - cos theta)
                - (m3 g l3 / 2) (1 - cos beta cos theta)

Index 0 is the reset. The potential's sign is opposite to that of S's (21), which credits lowering:
Table 3's NCOS column has dJ/dz = -(mu W + (m2 + m3) g), so lowering costs there. The last term is
(21)'s with its bracket corrected; printed is m3 g l2 / (2 (1 - cos beta cos theta)).
"""

import math

from solver.comparison.strawberry.mechanism import Mechanism, Posture


def energy_index(mechanism: Mechanism, posture: Posture) -> float:
    """J with Table 3's sign of the potential energy: lowering costs [J]."""
    return friction_loss(mechanism, posture) - potential_rise(mechanism, posture)


def printed_index(mechanism: Mechanism, posture: Posture) -> float:
    """J with the sign of (21) as printed: what the arm loses in height is gained [J]."""
    return friction_loss(mechanism, posture) + potential_rise(mechanism, posture)


def friction_loss(mechanism: Mechanism, posture: Posture) -> float:
    """Energy lost in the table's slides on the way from the reset [J] (S 22)."""
    m, q = mechanism, posture
    travel = (q.s10_m - m.s10.lower) + (q.s21_m - m.s21.lower) + (q.s32_m - m.s32.lower)
    return m.friction_n * travel


def potential_rise(mechanism: Mechanism, posture: Posture) -> float:
    """Potential energy of the arm above that at the reset [J] (S 20 less 19).

    The centres of mass are at half of DE (l2) and half of l3.
    """
    m, q = mechanism, posture
    cos_theta = math.cos(q.theta_rad)
    return (
        m.lifted_n * (m.s32.lower - q.s32_m)
        + bent_arm_n(m) * m.l2_m * (1.0 - cos_theta)
        + m.tip_weight_n * m.l3_m / 2.0 * (1.0 - math.cos(q.beta_rad) * cos_theta)
    )


def bent_arm_n(mechanism: Mechanism) -> float:
    """(m2 / 2 + m3) g [N]."""
    return (mechanism.lifted_n + mechanism.tip_weight_n) / 2.0
