"""Effort saved: by planning a batch as a whole, by choosing the order, by a symmetric tool."""

from typing import Any

import numpy as np

from bench.measure import Row, failed, row
from bench.subjects.given import planned_effort
from bench.targets import TargetSet, data_set_3, reachable_set
from solver import solve
from solver.approach.optimum.batch import closed_form_optima


def measure(quick: bool) -> list[Row]:
    """Per cent of effort saved, by batch."""
    count = 2 if quick else 10
    batches = [reachable_set(80 + seed, 5 if quick else 50) for seed in range(count)]
    rows = []
    for name, sets in {
        "data set 3": [data_set_3()],
        f"{count} random batches of {len(batches[0])}": batches,
    }.items():
        rows += [
            _saved(f"given against greedy, {name}", [_greedy(one) for one in sets], sets, "given"),
            _saved(f"optimal against given, {name}", _efforts(sets, "given"), sets, "optimal"),
            _saved(
                f"symmetric tool against not, {name}",
                _efforts(sets, "given"),
                sets,
                "given",
                symmetric_tool=True,
            ),
        ]
    return rows


def _efforts(sets: list[TargetSet], order: str, **options: Any) -> list[float]:
    efforts = []
    for targets in sets:
        problem = targets.problem(method="ssas", order=order, include=("path",), **options)
        plan = solve(problem)
        whole = plan.planned == len(targets)
        efforts.append(planned_effort(plan) if whole else float("nan"))
    return efforts


def _saved(
    name: str, before: list[float], sets: list[TargetSet], order: str, **options: Any
) -> Row:
    after = _efforts(sets, order, **options)
    shares = [100 * (1 - new / old) for new, old in zip(after, before, strict=True)]
    if not np.isfinite(shares).all():
        return failed(name, "%", "a batch was not planned as a whole")
    return row(name, shares, "%", note="of the total effort; median of the batches")


def _greedy(targets: TargetSet) -> float:
    """Total effort where each target takes its own optimum from the last one's standby."""
    problem = targets.problem(method="ssas")
    reference, total = np.asarray(problem.start), 0.0
    for k in range(len(targets)):
        one = targets[k : k + 1]
        found = closed_form_optima(problem, one.positions, one.directions, reference)
        total, reference = total + float(found.efforts[0]), found.paths[0, 0]
    return total
