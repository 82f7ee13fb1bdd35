"""Large batches: is the time linear in the targets, and the memory flat beyond the answer."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from bench.measure import Row, row

WANTED_GROWTH = 1.1
WANTED_MIB = 64.0
ROOT = Path(__file__).parents[2]
SIZES = (1_000, 10_000, 100_000)

_ONE = """
import json, sys, time
import numpy as np
from bench.subjects.large_batch import memory_mib
from bench.targets import random_set
from solver import solve
size = int(sys.argv[1])
options = {"method": "ssas", "order": "independent", "include": ("path",)}
solve(random_set(10, 5).problem(**options))
problem = random_set(11, size).problem(**options)
began = time.perf_counter()
plan = solve(problem)
elapsed = time.perf_counter() - began
peak, now = memory_mib("VmHWM"), memory_mib("VmRSS")
figures = {"elapsed_s": elapsed, "peak_mib": peak, "kept_mib": now, "planned": plan.planned}
print(json.dumps(figures))
"""


def measure(quick: bool) -> list[Row]:
    """Batches of growing size, a process each, on one core."""
    sizes = (20, 40) if quick else SIZES
    results = {size: _one(size) for size in sizes}
    rows = []
    for size, result in results.items():
        rows += [
            row(
                f"{size} targets",
                1e6 * result["elapsed_s"] / size,
                "µs a target",
                note=f"{result['planned']} planned; {result['elapsed_s']:.1f} s",
            ),
            row(f"{size} targets, peak memory", result["peak_mib"], "MiB"),
        ]
    first, last = results[sizes[0]], results[sizes[-1]]
    growth = (last["elapsed_s"] / sizes[-1]) / (first["elapsed_s"] / sizes[0])
    beyond = [result["peak_mib"] - result["kept_mib"] for result in (first, last)]
    rows += [
        row(
            f"time a target, {sizes[-1]} targets against {sizes[0]}",
            growth,
            "times",
            at_most=WANTED_GROWTH,
        ),
        row(
            f"peak beyond the answer, {sizes[-1]} targets above {sizes[0]}",
            beyond[1] - beyond[0],
            "MiB",
            at_most=WANTED_MIB,
            note="peak less what stays in memory with the plan held",
        ),
    ]
    return rows


def _one(size: int) -> Any:
    command = [sys.executable, "-c", _ONE, str(size)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    return json.loads(done.stdout)


def memory_mib(field: str) -> float:
    """A figure of this process's memory, such as its peak `VmHWM` [MiB]."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    (line,) = [line for line in lines if line.startswith(f"{field}:")]
    return int(line.split()[1]) / 1024
