"""Arms for kinematics tests: the table-top one, and variants with every offset and twist sign."""

import itertools
import math
from dataclasses import replace

from solver import Robot, load_robot


def arms() -> list[Robot]:
    """The table-top arm and sixteen variants with shoulder and elbow offsets."""
    tabletop = load_robot("tabletop")
    variants = [tabletop]
    for signs in itertools.product((1, -1), repeat=4):
        joints = list(tabletop.joints)
        for i, sign in zip((0, 2, 3, 4), signs, strict=True):
            joints[i] = replace(joints[i], alpha_rad=sign * math.pi / 2)
        joints[1] = replace(joints[1], d_m=0.03)
        joints[2] = replace(joints[2], a_m=0.02, d_m=0.01)
        joints[3] = replace(joints[3], offset_rad=0.3)
        name = "offsets" + "".join("+" if sign > 0 else "-" for sign in signs)
        variants.append(replace(tabletop, name=name, joints=tuple(joints)))
    return variants
