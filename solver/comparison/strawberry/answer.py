"""What a method answers for a target: a posture, or a `Reason` why there is none."""

from dataclasses import dataclass

from solver.comparison.strawberry.mechanism import Posture


@dataclass(frozen=True)
class Answer:
    """A method's own claim; only `verification.py` makes it a solution.

    Attributes:
        posture: joint values at the target [m, rad].
        index_j: what the method takes for the index of that posture [J].
        iterations: of what it iterates; 0 for a closed form.
        status: its own word for how it ended.
    """

    posture: Posture
    index_j: float
    iterations: int = 0
    status: str = "solved"
