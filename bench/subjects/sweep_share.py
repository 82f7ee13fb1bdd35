"""Against a sweep of 65,536 angles: is every target planned that it reaches, and none dearer."""

import time

import numpy as np
from numpy.typing import NDArray

from bench.measure import Row, row
from bench.reference import sweep_targets
from bench.targets import hard_set, random_set, together
from solver import solve
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH

WANTED_EXCESS = 1e-6
ANGLES = 65_536


def measure(quick: bool) -> list[Row]:
    """Shares and efforts of 2,000 seeded targets; the sweep uses every core."""
    easy, hard, angles = (30, 10, 1024) if quick else (1600, 400, ANGLES)
    targets = together(random_set(4, easy), hard_set(5, hard))
    problem = targets.problem(method="ssas", order="independent", include=("path",))
    sweep_targets(problem, targets[:1], 8)  # compiles
    began = time.perf_counter()
    swept = sweep_targets(problem, targets, angles)
    elapsed = time.perf_counter() - began
    found = closed_form_optima(
        problem, targets.positions, targets.directions, np.asarray(problem.start)
    )
    plan = solve(problem)
    planned = np.array([approach.status == "planned" for approach in plan.approaches])
    efforts = np.array([approach.effort or np.inf for approach in plan.approaches])
    reached, between = np.isfinite(swept.at_rows), np.isfinite(swept.between_rows)
    have = found.branches != NO_BRANCH
    where = (
        f"{easy} targets in a box, {hard} at limits, straight wrists and stretched arms; "
        f"{angles} angles"
    )
    excess = found.efforts[reached & have] / swept.at_rows[reached & have] - 1
    plan_excess = efforts[between & planned] / swept.between_rows[between & planned] - 1
    return [
        row(
            "share with an approach, of those the sweep reaches",
            100 * _share(have, reached),
            "%",
            runs=int(reached.sum()),
            at_least=100.0,
            note=f"arcs and 20 rows of the cut-in; {where}",
        ),
        row(
            "share planned and verified, of those the sweep reaches between the rows too",
            100 * _share(planned, between),
            "%",
            runs=int(between.sum()),
            at_least=100.0,
            note="limits held at eight postures between two rows as well",
        ),
        row(
            "largest effort above the sweep, relative",
            _largest(excess),
            "",
            runs=len(excess),
            at_most=WANTED_EXCESS,
            note="below zero: never above; at the rows",
        ),
        row(
            "largest effort of the verified plan above the sweep, relative",
            _largest(plan_excess),
            "",
            runs=len(plan_excess),
            at_most=WANTED_EXCESS,
            note="between the rows too",
        ),
        row(
            "effort of the sweep above the optimum, relative",
            list(-excess / (1 + excess)) if len(excess) else [],
            "",
            note="what finite angles cost",
        ),
        row(
            "targets that the sweep misses and the arcs reach",
            float(np.count_nonzero(have & ~reached)),
            "targets",
            runs=len(targets),
        ),
        row("time of the sweep itself", elapsed, "s", note="compiled, every core"),
    ]


def _share(those: NDArray[np.bool_], of: NDArray[np.bool_]) -> float:
    return float(np.count_nonzero(those & of)) / max(int(np.count_nonzero(of)), 1)


def _largest(excess: NDArray[np.float64]) -> float:
    return float(excess.max()) if len(excess) else float("nan")
