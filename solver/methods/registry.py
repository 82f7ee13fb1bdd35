"""The methods, one row each. Adding one is a file in `solver/methods` and a row here."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from solver.approach.optimum.on_arcs import ArcOptimum
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.analytic import solve_as
from solver.methods.any_arm import Solve, on_any_arm
from solver.methods.fixed_z import solve_fixed_z
from solver.methods.floating_z import solve_floating_z
from solver.methods.ncos import improved_in_chain, solve_ncos
from solver.methods.semi_analytic import solve_ssas
from solver.problem.options import MethodName

Improve = Callable[[ApproachTask, ArcOptimum, Sequence[float] | None], Candidate]
"""A better approach than one of a batch planned as one, and `others` in its place: from the task
seen from the standby before, the approach so far, and the next thinning posture if there is one."""


@dataclass(frozen=True)
class Method:
    """A way to solve one target's task definition, and all that is known of it by its name.

    Attributes:
        name: what requests call it.
        summary: a line for people.
        solve: a target's approach, or why there is none.
        targets_in_a_part: so many take well below a second on an arm with a closed form: that long
            a job may go on after a stop, and so much is lost when its process is killed.
        chooses_among_arcs: its choice is any approach on any feasible arc, so that a batch in a
            given or chosen order is planned as one.
        is_arc_optimum: it is the least effort over all feasible arcs and nothing more, so that many
            independent targets are planned by one kernel.
        improve: what it makes of its targets' approaches in a batch planned as one; None leaves
            them as they are.
        starts_cold: it is a programme that comparisons start from random postures too.
    """

    name: MethodName
    summary: str
    solve: Solve
    targets_in_a_part: int
    chooses_among_arcs: bool = False
    is_arc_optimum: bool = False
    improve: Improve | None = None
    starts_cold: bool = False


_ROWS = (
    Method(
        "fixed_z",
        "the approach along the world's x axis (T 3.4.1)",
        on_any_arm(solve_fixed_z),
        targets_in_a_part=100,
    ),
    Method(
        "floating_z",
        "evenly spaced approach angles, all branches (T 3.4.2)",
        on_any_arm(solve_floating_z),
        targets_in_a_part=100,
    ),
    Method(
        "as",
        "closed form, middle of the widest feasible arc (S remarks 1, 2)",
        on_any_arm(solve_as),
        targets_in_a_part=100,
    ),
    Method(
        "ssas",
        "closed form and the optimum over every feasible arc (S 3.2)",
        on_any_arm(solve_ssas),
        targets_in_a_part=250,
        chooses_among_arcs=True,
        is_arc_optimum=True,
    ),
    Method(
        "ncos",
        "nonlinear programme in CasADi, warm-started by ssas (S 3.3)",
        solve_ncos,
        targets_in_a_part=50,
        chooses_among_arcs=True,
        improve=improved_in_chain,
        starts_cold=True,
    ),
)

METHODS: Final[Mapping[MethodName, Method]] = MappingProxyType({row.name: row for row in _ROWS})
