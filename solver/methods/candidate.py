"""What a method proposes. The verifier decides whether it holds."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Candidate:
    """An approach proposed by a method; its postures follow from the closed form.

    Attributes:
        approach_angle_rad: the approach angle, in (-pi, pi].
        tool_side: 1 or -1.
        branch: inverse kinematics branch, 0 to 7.
        effort: what the method believes the effort to be.
        iterations: iterations or candidates the method spent.
        status: the method's own account.
    """

    approach_angle_rad: float
    tool_side: int
    branch: int
    effort: float
    iterations: int
    status: str
