"""From a posture to the order in which joints move (S remark 3), and back to the reset (step 7).

The table first goes to a height above the canopy, moves across, the arm takes its angles there,
and only then it is lowered. S prints "s32 + h_extra" for the first height; s32 counts downwards, so
what keeps the arm above the plants is s32 - h_extra.
"""

from dataclasses import dataclass
from typing import Final

from solver.comparison.strawberry.mechanism import JOINT_NAMES, Mechanism, Posture
from solver.exceptions import SolverError

OPEN: Final = "open"
CLOSE: Final = "close"


class PostureOutsideLimits(SolverError):
    """A command sequence was asked for a posture that the mechanism cannot take."""

    def __init__(self, joint: str, value: float) -> None:
        super().__init__(f"{joint} would be outside its limits: {value}")
        self.joint = joint
        self.value = value


@dataclass(frozen=True)
class Command:
    """One command: a joint and where it goes, or the end-effector.

    Attributes:
        joint: "s10" to "psi", or "end_effector".
        value: its goal [m or rad]; None for the end-effector.
        action: "open" or "close" for the end-effector; "move" otherwise.
    """

    joint: str
    value: float | None = None
    action: str = "move"


@dataclass(frozen=True)
class CommandSequence:
    """Commands in order, one after the other is done.

    Attributes:
        commands: from the reset to the leaf.
        back: from the leaf to the reset. S prints the goal of this only; the order is the reverse,
            so that the arm is lifted out of the canopy before it turns.
        extra_height_m: how far above s32 the arm takes its angles: h_extra, or less where the table
            does not reach that high.
        shortened: whether it is less.
    """

    commands: tuple[Command, ...]
    back: tuple[Command, ...]
    extra_height_m: float
    shortened: bool


def command_sequence(
    mechanism: Mechanism, posture: Posture, psi_rad: float = 0.0
) -> CommandSequence:
    """The commands that bring the mechanism from the reset to a posture and back.

    Args:
        mechanism: the mechanism.
        posture: inside the limits.
        psi_rad: turn of the end-effector about its own axis [rad].

    Raises:
        PostureOutsideLimits: a joint's value is not inside its limits.
    """
    m, reset = mechanism, mechanism.reset
    values, spans = (*posture, psi_rad), (*m.limits, m.psi)
    for joint, value, span in zip((*JOINT_NAMES, "psi"), values, spans, strict=True):
        if not span.lower <= value <= span.upper:
            raise PostureOutsideLimits(joint, value)
    above = max(posture.s32_m - m.extra_height_m, m.s32.lower)
    commands = (
        Command("end_effector", action=OPEN),
        Command("s32", above),
        Command("s10", posture.s10_m),
        Command("s21", posture.s21_m),
        Command("theta", posture.theta_rad),
        Command("beta", posture.beta_rad),
        Command("psi", psi_rad),
        Command("s32", posture.s32_m),
        Command("end_effector", action=CLOSE),
    )
    back = (
        Command("s32", above),
        Command("psi", 0.0),
        Command("beta", reset.beta_rad),
        Command("theta", reset.theta_rad),
        Command("s21", reset.s21_m),
        Command("s10", reset.s10_m),
        Command("s32", reset.s32_m),
    )
    return CommandSequence(
        commands, back, posture.s32_m - above, posture.s32_m - m.extra_height_m < m.s32.lower
    )
