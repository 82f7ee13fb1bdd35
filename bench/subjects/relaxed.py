"""`ncos` with a strike zone and a tilt, on targets that `ssas` refuses."""

import math

import numpy as np

from bench.measure import Row, row
from bench.subjects.ncos import plan_each
from bench.targets import feasible, random_set

STRIKE = {"strike_zone_m": 0.02}
TILT = {"tilt_tolerance_rad": math.radians(10.0)}
CASES = (
    ("sqp", "2 cm strike zone and 10° tilt", STRIKE | TILT, 15.0, 120.0),
    ("ipopt", "2 cm strike zone and 10° tilt", STRIKE | TILT, None, None),
    ("sqp", "2 cm strike zone", STRIKE, 25.0, None),
    ("sqp", "10° tilt", TILT, None, None),
)
"""Backend, name, options, and what is wanted of the median and of 99 in 100 [ms]."""


def measure(quick: bool) -> list[Row]:
    """Which share of refused targets is planned with the relaxations, and how long that takes."""
    drawn = random_set(7, 8 if quick else 300)
    refused = drawn[~feasible(drawn)]
    rows = []
    for backend, name, options, median_ms, most_ms in CASES:
        approaches, times = plan_each(refused, method="ncos", nlp_backend=backend, **options)
        planned = np.array([approach.status == "planned" for approach in approaches])
        rows += [
            row(
                f"rescued by {backend}, {name}",
                100 * float(planned.mean()),
                "%",
                runs=len(refused),
                note=f"{planned.sum()} of all targets in a box that ssas refuses",
            ),
            row(f"{backend}, {name}", times, "ms a target", at_most=median_ms),
        ]
        if most_ms is not None:
            slow = float(np.quantile(times, 0.99))
            rows.append(
                row(
                    f"{backend}, {name}, 99 of 100",
                    slow,
                    "ms a target",
                    runs=len(refused),
                    at_most=most_ms,
                )
            )
    return rows
