"""Certificates of seeded targets: gaps, cells and times. Run as `python -m bench.certificate`."""

import argparse
import json
import math
import sys
import time
from typing import Any

import numpy as np

from solver import Options, Problem, Target, load_robot
from solver.approach.certificate import Certificate, certify_task
from solver.approach.task import ApproachTask, approach_task
from solver.methods.semi_analytic import best_on_arcs
from solver.tolerances import CERTIFICATE_GAP

QUANTILES = (0.5, 0.9, 0.99, 1.0)


def seeded_targets(seed: int, count: int) -> list[Target]:
    """Targets in a box in front of the table-top arm, branches in every direction [m]."""
    rng = np.random.default_rng(seed)
    positions = rng.uniform((0.05, -0.3, 0.05), (0.38, 0.3, 0.5), (count, 3))
    directions = rng.normal(size=(count, 3))
    return [
        Target(str(k), tuple(position), tuple(direction))
        for k, (position, direction) in enumerate(zip(positions, directions, strict=True))
    ]


def certificates(seed: int, count: int, norm: str, repeats: int) -> dict[str, Any]:
    """Quantiles of gap, cells and time for `ssas`'s answers, and proofs of its refusals."""
    problem = Problem(
        load_robot("tabletop"), seeded_targets(seed, count), options=Options(norm=norm)
    )
    tasks = [approach_task(problem, target, problem.start) for target in problem.targets]
    certify_task(tasks[0], None)  # compiles
    gaps, cells, times_ms, refused, proven, incomplete, beaten = [], [], [], 0, 0, 0, 0
    for task in tasks:
        best = best_on_arcs(task)
        certificate, time_ms = _timed(task, None if best is None else best.effort, repeats)
        cells.append(certificate.cells)
        times_ms.append(time_ms)
        incomplete += not certificate.complete
        if best is None:
            refused += 1
            proven += certificate.lower_bound == math.inf
        else:
            beaten += certificate.known_effort < best.effort * (1 - CERTIFICATE_GAP)
            gaps.append(1 - certificate.lower_bound / best.effort)
    return {
        "targets": count, "seed": seed, "norm": norm,
        "planned": len(gaps), "refused": refused, "refusals_proven": proven,
        "incomplete": incomplete, "ssas_beaten": beaten, "quantiles": QUANTILES,
        "gap": np.quantile(gaps, QUANTILES).tolist(),
        "cells": np.quantile(cells, QUANTILES).tolist(),
        "time_ms": np.quantile(times_ms, QUANTILES).tolist(),
    }  # fmt: skip


def _timed(task: ApproachTask, incumbent: float | None, repeats: int) -> tuple[Certificate, float]:
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        certificate = certify_task(task, incumbent)
        times.append(time.perf_counter() - started)
    return certificate, min(times) * 1e3


def main() -> None:
    """Writes one JSON object to standard output."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--norm", choices=("l1", "l2"), default="l1")
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    result = certificates(given.seed, given.targets, given.norm, given.repeats)
    sys.stdout.write(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()
