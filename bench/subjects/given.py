"""Order `given`: time, and effort against ladder graphs of evenly spaced angles."""

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from bench.measure import Row, failed, row, scaled, times_of
from bench.reference import Ladder, build_ladder, ladder_effort
from bench.targets import TargetSet, data_set_3, reachable_set
from solver import Plan, Problem, solve

DESCARTES_ANGLES = 72
FINE_ANGLES = 1440
WANTED_EXCESS = 1e-9

Answer = TypeVar("Answer")


def measure(quick: bool) -> list[Row]:
    """Data set 3 and 100 random targets that can be reached."""
    sets = {
        "data set 3": (data_set_3(), 2.0),
        "100 random targets": (reachable_set(9, 8 if quick else 100), 40.0),
    }
    rows: list[Row] = []
    for name, (targets, wanted_ms) in sets.items():
        problem = targets.problem(method="ssas", order="given", include=("path",))
        times = times_of(lambda problem=problem: solve(problem), 2 if quick else 9)  # type: ignore[misc]
        rows.append(
            row(
                f"given, {name}",
                scaled(times, 1e3),
                "ms",
                at_most=wanted_ms,
                note=f"verified plan of {len(targets)} targets, each with an approach",
            )
        )
        rows += _against_ladder(problem, targets, name, DESCARTES_ANGLES, None)
        fine = 360 if quick else FINE_ANGLES
        rows += _against_ladder(problem, targets, name, fine, WANTED_EXCESS)
    return rows


def planned_effort(plan: Plan) -> float:
    """The total effort of a plan's planned targets."""
    return sum(approach.effort or 0.0 for approach in plan.approaches)


def _against_ladder(
    problem: Problem, targets: TargetSet, name: str, angles: int, wanted: float | None
) -> list[Row]:
    build_ladder(problem, targets[:1], 8)  # compiles
    ladder, built_s = _timed(lambda: build_ladder(problem, targets, angles))
    reached = ladder.reached
    label = f"ladder graph of {angles} angles, {name}"
    if not reached.any():
        return [failed(label, "ms", "no target has a node", "")]
    kept = _without_empty_layers(ladder)
    ladder_effort(problem, kept)
    total, searched_s = _timed(lambda: ladder_effort(problem, kept))
    ours = solve(targets[reached].problem(method="ssas", order="given", include=("path",)))
    missed = int(np.count_nonzero(~reached))
    return [
        row(
            label,
            1e3 * (built_s + searched_s),
            "ms",
            note=f"compiled, for this arm only; it finds no approach to {missed} targets",
        ),
        row(
            f"effort of given above the ladder graph of {angles} angles, {name}",
            planned_effort(ours) / total - 1 if ours.planned == reached.sum() else float("nan"),
            "relative",
            runs=len(targets),
            at_most=wanted,
            note="below zero: cheaper; on the targets the ladder reaches",
        ),
    ]


def _without_empty_layers(ladder: Ladder) -> Ladder:
    return Ladder(ladder.thinning, ladder.standby, np.unique(ladder.layers))


def _timed(action: Callable[[], Answer]) -> tuple[Answer, float]:
    began = time.perf_counter()
    answer = action()
    return answer, time.perf_counter() - began
