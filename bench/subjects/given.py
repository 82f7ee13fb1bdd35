"""Order `given`: time, and effort against ladder graphs of evenly spaced angles."""

import numpy as np

from bench.measure import Row, alternating, failed, row, scaled
from bench.reference import build_ladder, ladder_effort
from bench.targets import TargetSet, data_set_3, reachable_set
from solver import Plan, solve
from solver.sequencing.sequence import sequence

DESCARTES_ANGLES = 72
FINE_ANGLES = 1440
WANTED_EXCESS = 1e-9


def measure(quick: bool) -> list[Row]:
    """Data set 3 and 100 random targets that can be reached."""
    random = reachable_set(9, 8 if quick else 100)
    angles = 360 if quick else FINE_ANGLES
    rows: list[Row] = []
    for name, targets, wanted_ms in (
        ("data set 3", data_set_3(), 2.0),
        (f"{len(random)} random targets", random, 40.0),
    ):
        rows += _times(name, targets, wanted_ms, 2 if quick else 9)
        rows.append(_above_ladder(name, targets, DESCARTES_ANGLES, None))
        rows.append(_above_ladder(name, targets, angles, WANTED_EXCESS))
    return rows


def planned_effort(plan: Plan) -> float:
    """The total effort of a plan's planned targets."""
    return sum(approach.effort or 0.0 for approach in plan.approaches)


def _times(name: str, targets: TargetSet, wanted_ms: float, runs: int) -> list[Row]:
    problem = targets.problem(method="ssas", order="given", include=("path",))

    def ladder() -> float:
        return ladder_effort(problem, build_ladder(problem, targets, DESCARTES_ANGLES))

    actions = {
        "given": lambda: sequence(problem),
        "ladder": ladder,
        "plan": lambda: solve(problem),
    }
    times = alternating(actions, runs)
    return [
        row(
            f"given, {name}",
            scaled(times["given"], 1e3),
            "ms",
            at_most=wanted_ms,
            note="arcs, chain and cut-ins, limits between their rows too, as the ladder graph does",
        ),
        row(
            f"ladder graph of {DESCARTES_ANGLES} angles, {name}",
            scaled(times["ladder"], 1e3),
            "ms",
            note="as Descartes does it, but compiled for this arm only",
        ),
        row(f"verified plan by given, {name}", scaled(times["plan"], 1e3), "ms"),
    ]


def _above_ladder(name: str, targets: TargetSet, angles: int, wanted: float | None) -> Row:
    label = f"effort of given above the ladder graph of {angles} angles, {name}"
    problem = targets.problem()
    ladder = build_ladder(problem, targets, angles)
    reached = ladder.reached
    if not reached.any():
        return failed(label, "relative", "the ladder graph has no node")
    ours = solve(targets[reached].problem(method="ssas", order="given", include=("path",)))
    count = int(np.count_nonzero(reached))
    whole = ours.planned == count
    return row(
        label,
        planned_effort(ours) / ladder_effort(problem, ladder) - 1 if whole else float("nan"),
        "relative",
        runs=count,
        at_most=wanted,
        note=f"below zero: cheaper; the ladder reaches {count} of {len(reached)}",
    )
