"""The scenario `strawberry`: the 20 targets of S's Table 3, its three methods, its misprints."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

from solver.comparison.contest import Account, Contest, Entrant, Published
from solver.comparison.strawberry.analytic import solve_as
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.as_printed import (
    solve_as_printed,
    solve_as_printed_18,
    solve_ssas_printed,
    solve_ssas_printed_without_30,
)
from solver.comparison.strawberry.mechanism import Mechanism, Point, load_mechanism
from solver.comparison.strawberry.programme import solve_ncos, solve_ncos_cold
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.table_3 import MACHINE, table_3
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import PLANNED, Reason

Solve = Callable[[Mechanism, Point], Answer | Reason]

N_MM_IN_J: Final = 1000.0

_METHODS: Final[tuple[tuple[str, str, Solve, Solve | None], ...]] = (
    ("as", "closed form, algorithm 1 corrected (S 3.1)", solve_as, None),
    ("ssas", "least index over s10 along the theta of as (S 3.2)", solve_ssas, None),
    ("ncos", "problem P2 in CasADi, cold from the reset (S 3.3)", solve_ncos, solve_ncos_cold),
    ("as_printed", "algorithm 1 to the letter", solve_as_printed, None),
    ("as_printed_18", "algorithm 1 corrected up to equation (18)", solve_as_printed_18, None),
    ("ssas_printed", "problem P1 as printed, with equality (30)", solve_ssas_printed, None),
    (
        "ssas_printed_without_30",
        "problem P1 with (21)'s sign, without equality (30)",
        solve_ssas_printed_without_30,
        None,
    ),
)

METHODS: Final[Mapping[str, Solve]] = MappingProxyType({row[0]: row[2] for row in _METHODS})
"""Every method of the scenario by name, warm."""

NOTES: Final = (
    "One index for all methods: energy from the reset, with the sign of the potential energy of "
    "Table 3's NCOS column (lowering costs), which is opposite to that of the printed equation "
    "(21).",
    "The paper prints neither masses nor offsets. d_x, d_z and m3 g are unknown, d_y is known "
    "between bounds. One constant is fitted to the NCOS column, nothing to the other two.",
    "The SSAS column cannot be reproduced: SSAS - NCOS is a constant in each quadrant of the "
    "plant, and another in each. Along AS's choice theta is 0 at all 20 targets, which gives one "
    "constant for all of them; where it is not 0 the difference changes with the target. Whatever "
    "the unknowns are, four constants are out of reach. Nor can AS's column be where the limit of "
    "s10 cuts off its choice: the printed AS - NCOS falls there by up to 41.4 N mm, ours rises.",
    "The rows named printed show the text's misprints; they are expected to fail or to be dearer.",
)


def strawberry_contest() -> Contest:
    """The contest over Table 3; the index is reported in N mm, as printed there."""
    mechanism, rows = load_mechanism(), table_3()
    targets = tuple(row.target for row in rows)
    published = {
        (row.label, method): Published(row.index_n_mm[method], row.time_s[method])
        for row in rows
        for method in row.index_n_mm
    }

    def account(entrant: str, number: int, answer: Any) -> Account:
        return account_for(mechanism, targets[number], answer)

    return Contest(
        scenario="strawberry",
        title="Strawberry mechanism: the 20 targets of Table 3",
        origin="S. G. Defterli and Y. Xu 2017, Table 3; targets as printed",
        index_name="J [N mm]",
        target_ids=tuple(row.label for row in rows),
        entrants=tuple(
            Entrant(
                name,
                summary,
                _numbered(solve, mechanism, targets),
                None if cold is None else _numbered(cold, mechanism, targets),
            )
            for name, summary, solve, cold in _METHODS
        ),
        account=account,
        notes=NOTES,
        published=published,
        published_on=MACHINE,
        reference="ncos",
    )


def account_for(mechanism: Mechanism, target: Point, answer: Answer | Reason) -> Account:
    """An answer as the verifier finds it; its index in N mm."""
    if isinstance(answer, Reason):
        return Account(solved=False, status=answer.code, detail=answer.detail)
    found = verify_answer(mechanism, target, answer)
    residuals = {entry.name: entry.value for entry in found.verification.residuals}
    if not found.verification.accepted:
        broken = ", ".join(
            f"{entry.name} {entry.value:.3g} (allowed {entry.allowed:.0e})"
            for entry in found.verification.failures
        )
        return Account(
            solved=False,
            status="solver_failed",
            detail=f"refused by the verifier: {broken}",
            residuals=residuals,
            joints=_finite(answer.posture),
            iterations=answer.iterations,
        )
    return Account(
        solved=True,
        status=PLANNED,
        index=found.index_j * N_MM_IN_J,
        residuals=residuals,
        margin=found.margin,
        joints=tuple(answer.posture),
        iterations=answer.iterations,
    )


def _numbered(
    solve: Solve, mechanism: Mechanism, targets: tuple[Point, ...]
) -> Callable[[int], Answer | Reason]:
    return lambda number: solve(mechanism, targets[number])


def _finite(joints: tuple[float, ...]) -> tuple[float, ...] | None:
    return tuple(joints) if all(map(math.isfinite, joints)) else None
