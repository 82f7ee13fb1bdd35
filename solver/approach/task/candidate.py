"""What a method proposes. The verifier decides whether it holds."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Candidate:
    """An approach proposed by a method: the thinning posture, from which its cut-in follows.

    Attributes:
        approach_angle_rad: the approach angle, in (-pi, pi].
        tool_side: 1 or -1.
        branch: inverse kinematics branch, 0 to 7; None for an arm without a closed form.
        thinning_joints: posture at the target, shape (joints,) [rad or m].
        effort: what the method believes the effort to be.
        iterations: iterations or candidates the method spent.
        status: the method's own account.
        others: what the method proposes where this one does not verify, the best first.
    """

    approach_angle_rad: float
    tool_side: int
    branch: int | None
    thinning_joints: Sequence[float]
    effort: float
    iterations: int
    status: str
    others: tuple["Candidate", ...] = ()
