"""Whether more room is ever dearer: pairs of zones, one inside the other, of the same target."""

import math

import numpy as np

from bench.measure import Row, row
from bench.targets import TargetSet, random_set
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task
from solver.methods.registry import METHODS

LARGEST = (0.04, 0.5)
"""Strike zone [m] and tilt tolerance [rad] up to which zones are drawn."""

DEARER = 1e-6
"""Relative difference of two efforts from which one is dearer: the backends' own agreement."""

WANTED_SHARE, WANTED_WORST = 99.9, 1.0


def measure(quick: bool) -> list[Row]:
    """Share of pairs in which the larger zone is not dearer, and the worst, off the ladder."""
    count = 40 if quick else 10_000
    targets, rng = random_set(12, count), np.random.default_rng(13)
    dearer = []
    planned = lost = 0
    for k in range(count):
        larger = rng.uniform(0.05, 1.0, 2) * LARGEST * (rng.random(2) < (0.75, 0.75))
        # Half of the pairs differ in one of the two alone.
        smaller = larger * np.maximum(rng.random(2), rng.random(2) < 0.25)
        efforts = [_effort(targets[k : k + 1], *zone) for zone in (smaller, larger)]
        if not math.isfinite(efforts[0]):
            continue
        planned += 1
        lost += math.isinf(efforts[1])
        if math.isfinite(efforts[1]) and efforts[1] > efforts[0] * (1 + DEARER):
            dearer.append(100 * (efforts[1] / efforts[0] - 1))
    well = 100 * (1 - (len(dearer) + lost) / max(planned, 1))
    return [
        row(
            "pairs in which more room is not dearer",
            well,
            "%",
            runs=planned,
            at_least=WANTED_SHARE,
            note=f"of {count} targets in a box those that the smaller zone plans; the larger one "
            f"refuses {lost}",
        ),
        row(
            "dearer by, at worst", max(dearer, default=0.0), "%", runs=planned, at_most=WANTED_WORST
        ),
    ]


def _effort(targets: TargetSet, strike_m: float, tilt_rad: float) -> float:
    problem = targets.problem(
        order="independent", strike_zone_m=float(strike_m), tilt_tolerance_rad=float(tilt_rad)
    )
    task = approach_task(problem, problem.targets[0], problem.start)
    outcome = METHODS["ncos"].solve(task)
    return outcome.effort if isinstance(outcome, Candidate) else math.inf
