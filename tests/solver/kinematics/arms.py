"""Arms for tests: the table-top one, variants with every offset and twist sign, and others."""

import itertools
import math
from dataclasses import replace
from pathlib import Path

from solver import Robot, load_robot


def arms() -> list[Robot]:
    """The table-top arm, one that hangs askew, the PUMA, and sixteen with every offset and sign."""
    tabletop = load_robot("tabletop")
    hanging = replace(
        tabletop,
        name="hanging",
        mount_position_m=(0.3, -0.2, 0.9),
        mount_rpy_rad=(math.pi, 0.4, -0.7),
        flange_roll_rad=0.6,
    )
    variants = [tabletop, hanging, load_robot("puma560")]
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


def ur5() -> Robot:
    """A published arm without a spherical wrist."""
    return load_robot(Path(__file__).parents[1] / "robots" / "ur5.toml")


def seven_joints() -> Robot:
    """A redundant arm: the published rows of KUKA's LBR iiwa 7 R800, with the UR5's speeds."""
    lengths = (0.34, 0.0, 0.4, 0.0, 0.4, 0.0, 0.126)
    twists = (-90, 90, 90, -90, -90, 90, 0)
    limits = (170, 120, 170, 120, 170, 120, 175)
    pattern = ur5().joints[0]
    joints = tuple(
        replace(
            pattern,
            name=f"joint_{i + 1}",
            a_m=0.0,
            d_m=length,
            alpha_rad=math.radians(twist),
            lower=-math.radians(limit),
            upper=math.radians(limit),
            link=None,
        )
        for i, (length, twist, limit) in enumerate(zip(lengths, twists, limits, strict=True))
    )
    home = (0.0, 0.5, 0.0, -1.2, 0.0, 0.9, 0.0)
    return replace(ur5(), name="seven", joints=joints, home_joints=home, flange_roll_rad=0.4)
