"""The start of a second process: imports, kernels from the cache, one target planned."""

import subprocess
import sys
import time

from bench.measure import Row, row

WANTED_S = 3.0

_PLAN = """
from solver import Options, Problem, Target, load_robot, solve
target = Target("1", position_m=(0.185, -0.057, 0.42), branch_direction=(-1, -1, 1))
plan = solve(Problem(load_robot("tabletop"), [target], options=Options(method="{method}")))
assert plan.planned == 1
"""


def measure(quick: bool) -> list[Row]:
    """Seconds from nothing to a verified plan, for the closed form and the programme."""
    rows = []
    for method in ("ssas",) if quick else ("ssas", "ncos"):
        command = [sys.executable, "-c", _PLAN.format(method=method)]
        times = []
        for count in range(2 if quick else 6):
            began = time.perf_counter()
            subprocess.run(command, check=True)
            if count:  # the first fills the cache
                times.append(time.perf_counter() - began)
        rows.append(
            row(
                f"process to a verified plan by {method}",
                times,
                "s",
                at_most=WANTED_S,
                note="one target; interpreter, imports and kernels included",
            )
        )
    return rows
