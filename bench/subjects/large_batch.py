"""Large batches: is the time linear in the targets, and the memory flat beyond the answer."""

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench.measure import Row, row

WANTED_GROWTH = 1.1
WANTED_MIB = 64.0
ROOT = Path(__file__).parents[2]
SIZES = (1_000, 10_000, 100_000)
PLAN_SIZES = (1_000, 10_000)

_ONE = """
import json, sys, time
import numpy as np
from bench.subjects.large_batch import memory_mib
from bench.targets import random_set
from solver import solve
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH
size, whole = int(sys.argv[1]), sys.argv[2] == "plan"
options = {"method": "ssas", "order": "independent", "include": ("path",)}

def answer(targets):
    if whole:
        return solve(targets.problem(**options))
    few = targets[:1].problem(**options)
    return closed_form_optima(few, targets.positions, targets.directions, np.asarray(few.start))

answer(random_set(10, 5))
targets = random_set(11, size)
began = time.perf_counter()
found = answer(targets)
elapsed = time.perf_counter() - began
peak, now = memory_mib("VmHWM"), memory_mib("VmRSS")
planned = found.planned if whole else int(np.count_nonzero(found.branches != NO_BRANCH))
figures = {"elapsed_s": elapsed, "peak_mib": peak, "kept_mib": now, "planned": planned}
print(json.dumps(figures))
"""


def measure(quick: bool) -> list[Row]:
    """Batches of growing size, a process each, on one core."""
    sizes, plan_sizes = ((20, 40), (20, 40)) if quick else (SIZES, PLAN_SIZES)
    results = {size: _one(size, "optima") for size in sizes}
    rows = []
    for size, result in results.items():
        rows += [
            row(
                f"{size} targets",
                1e6 * result["elapsed_s"] / size,
                "µs a target",
                note=f"{result['planned']} with an approach, 20 postures each; "
                f"{result['elapsed_s']:.1f} s",
            ),
            row(f"{size} targets, peak memory", result["peak_mib"], "MiB"),
        ]
    rows += _growth("approaches", results)
    plans = {size: _one(size, "plan") for size in plan_sizes}
    rows += [
        row(
            f"verified plan, {size} targets",
            1e6 * result["elapsed_s"] / size,
            "µs a target",
            note=f"{result['planned']} planned, the others explained; {result['elapsed_s']:.1f} s",
        )
        for size, result in plans.items()
    ]
    return [*rows, *_growth("verified plans", plans)]


def _growth(what: str, results: Mapping[int, Any]) -> list[Row]:
    small, large = min(results), max(results)
    first, last = results[small], results[large]
    growth = (last["elapsed_s"] / large) / (first["elapsed_s"] / small)
    beyond = [result["peak_mib"] - result["kept_mib"] for result in (first, last)]
    return [
        row(
            f"time a target, {large} {what} against {small}",
            growth,
            "times",
            at_most=WANTED_GROWTH,
        ),
        row(
            f"peak beyond the answer, {large} {what} above {small}",
            beyond[1] - beyond[0],
            "MiB",
            at_most=WANTED_MIB,
            note="peak less what stays in memory with the answer held",
        ),
    ]


def _one(size: int, what: str) -> Any:
    command = [sys.executable, "-c", _ONE, str(size), what]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    return json.loads(done.stdout)


def memory_mib(field: str) -> float:
    """A figure of this process's memory, such as its peak `VmHWM` [MiB]."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    (line,) = [line for line in lines if line.startswith(f"{field}:")]
    return int(line.split()[1]) / 1024
