"""Certificates: how near proven bounds are, what they cost, and whether refusals are proven."""

import math
from functools import partial

from bench.measure import Row, row, scaled, times_of
from bench.targets import random_set
from solver.approach.bounds.certificate import certify_task
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task

WANTED_GAP = 1e-6


def measure(quick: bool) -> list[Row]:
    """Gaps, cells and times of targets in the box, and proofs of refusals."""
    problem = random_set(12, 20 if quick else 1000).problem()
    gaps, cells, times, refused, proven, incomplete = [], [], [], 0, 0, 0
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        best = best_on_arcs(task)
        incumbent = None if best is None else best.effort
        asked = partial(certify_task, task, incumbent)
        (elapsed,) = times_of(asked, 1)
        certificate = asked()
        cells.append(float(certificate.cells))
        times.append(elapsed)
        incomplete += not certificate.complete
        if best is None:
            refused += 1
            proven += certificate.lower_bound == math.inf
        else:
            gaps.append(1 - certificate.lower_bound / best.effort)
    return [
        row(
            "largest gap between effort and proven bound, relative",
            max(gaps),
            "",
            runs=len(gaps),
            at_most=WANTED_GAP,
            note=f"{incomplete} of {len(cells)} ended at the budget",
        ),
        row("gaps", gaps, "relative"),
        row("cells looked at", cells, "cells"),
        row("time of a certificate", scaled(times, 1e3), "ms"),
        row(
            "share of refusals proven",
            100 * proven / refused if refused else math.nan,
            "%",
            runs=refused,
            at_least=100.0,
        ),
    ]
