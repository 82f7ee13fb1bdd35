"""Refusals: what explaining one costs, and how near the change that it offers is to the nearest."""

import time

import numpy as np

from bench.measure import Row, row, scaled
from bench.nearest import shorter_at_random, shortest_from_everywhere
from bench.targets import feasible, random_set
from solver.approach.arcs.arcs import sample_angles
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.task import ApproachTask, approach_task
from solver.robots.model import Array

ANGLES = 72
SCATTERED = 300
"""Displacements tried at random for each target, shorter than the best known."""

TOO_FAR = 1.02
WANTED_MS = 0.3


def measure(quick: bool) -> list[Row]:
    """Refused targets of the box, each explained, and its offer against a brute force."""
    drawn = random_set(21, 20 if quick else 1900)
    refused = drawn[~feasible(drawn)]
    problem = refused[: 1000 if not quick else 8].problem()
    tasks = [approach_task(problem, target, problem.start) for target in problem.targets]
    diagnose(tasks[0])
    times, ratios, none = [], [], 0
    rng = np.random.default_rng(22)
    for task in tasks:
        began = time.perf_counter()
        nearest = diagnose(task).nearest
        times.append(time.perf_counter() - began)
        if nearest is None or not nearest.verified:
            none += 1
            continue
        offered = float(np.linalg.norm(nearest.displacement_m))
        ratios.append(offered / min(offered, _brute_force(task, rng, nearest.displacement_m)))
    too_far = sum(ratio > TOO_FAR for ratio in ratios)
    name = "offers more than 2 % further than a brute force finds"
    note = f"{none} of {len(tasks)} refusals offer none that verifies"
    return [
        row("a refusal explained", scaled(times, 1e3), "ms", at_most=WANTED_MS),
        row(name, too_far, "", runs=len(ratios), at_most=0, note=note),
        row("offers as multiples of what it finds", ratios, ""),
    ]


def _brute_force(
    task: ApproachTask, rng: np.random.Generator, around: tuple[float, float, float]
) -> float:
    """The shortest displacement known [m], half of those at random in a cone around the offer."""
    offered = float(np.linalg.norm(around))
    shortest = shortest_from_everywhere(task.for_kernels(1), sample_angles(ANGLES))
    directions = rng.normal(size=(SCATTERED, 3))
    directions[: SCATTERED // 2] = np.array(around) / offered + 0.4 * directions[: SCATTERED // 2]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    lengths: Array = min(offered, shortest) * (1.0 - 0.3 * rng.uniform(size=SCATTERED) ** 3)
    return float(min(shortest, shorter_at_random(task.packed(1), directions, lengths)))
