"""Data set 3 beside what the thesis claims for its program of 2012."""

from bench.measure import Row, row, scaled, times_of
from bench.targets import data_set_3
from solver import solve

CLAIM_TARGET_S = 7.7
"""T's time for a target."""

CLAIM_SWEEP_S = 5.5
"""T's time for its floating z-axis method with 50 angles."""


def measure(quick: bool) -> list[Row]:
    """Milliseconds a target, verified and timed trajectories included, by method."""
    rows = [
        row("thesis, a target", 1e3 * CLAIM_TARGET_S, "ms a target", note="published, 2012"),
        row("thesis, 50 angles", 1e3 * CLAIM_SWEEP_S, "ms a target", note="published, 2012"),
    ]
    targets = data_set_3()
    for method in ("floating_z", "ssas", "ncos"):
        for name, include in (("path", ("path",)), ("path, transfer and trajectory", None)):
            problem = targets.problem(method=method, order="given", include=include)
            times = times_of(lambda problem=problem: solve(problem), 1 if quick else 9)  # type: ignore[misc]
            each = scaled(times, 1e3 / len(targets))
            rows.append(row(f"{method}, {name}", each, "ms a target"))
    return rows
