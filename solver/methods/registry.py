"""The methods, one row each. Adding one is a file in `solver/methods` and a row here."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.analytic import solve_as
from solver.methods.any_arm import on_any_arm
from solver.methods.fixed_z import solve_fixed_z
from solver.methods.floating_z import solve_floating_z
from solver.methods.ncos import solve_ncos
from solver.methods.semi_analytic import solve_ssas
from solver.problem.solution import Reason


@dataclass(frozen=True)
class Method:
    """A way to solve one target's task definition.

    Attributes:
        name: what requests call it.
        summary: a line for people.
        solve: a target's approach, or why there is none.
        chooses_among_arcs: its choice is any approach on any feasible arc, so that a batch in a
            given or chosen order is planned as one.
    """

    name: str
    summary: str
    solve: Callable[[ApproachTask], Candidate | Reason]
    chooses_among_arcs: bool = False


_ROWS = (
    Method("fixed_z", "the approach along the world's x axis (T 3.4.1)", on_any_arm(solve_fixed_z)),
    Method(
        "floating_z",
        "evenly spaced approach angles, all branches (T 3.4.2)",
        on_any_arm(solve_floating_z),
    ),
    Method(
        "as",
        "closed form, middle of the widest feasible arc (S remarks 1, 2)",
        on_any_arm(solve_as),
    ),
    Method(
        "ssas",
        "closed form and the optimum over every feasible arc (S 3.2)",
        on_any_arm(solve_ssas),
        chooses_among_arcs=True,
    ),
    Method("ncos", "nonlinear programme in CasADi, warm-started by ssas (S 3.3)", solve_ncos, True),
)

METHODS: Final[Mapping[str, Method]] = MappingProxyType({row.name: row for row in _ROWS})
