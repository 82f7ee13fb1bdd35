"""What the services tell of themselves, to whoever counts it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class PlanFigures:
    """A plan in a few figures, so that nobody has to read its JSON again to count.

    Attributes:
        method: that solved it.
        planned: targets with an approach.
        infeasible: how many targets for each code of a reason.
        elapsed_s: the solver's own time.
    """

    method: str
    planned: int
    infeasible: Mapping[str, int]
    elapsed_s: float

    @property
    def targets(self) -> int:
        """All targets of the batch."""
        return self.planned + sum(self.infeasible.values())


class Measures(Protocol):
    """Counts. Its calls are cheap and never fail."""

    def solver_load(self, running: int, waiting: int) -> None:
        """So many tasks are with the solver processes now, and so many wait for one."""

    def solved(self, figures: PlanFigures) -> None:
        """A batch was solved."""

    def solver_lost(self) -> None:
        """A solver process died."""
