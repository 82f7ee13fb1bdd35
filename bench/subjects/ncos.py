"""`ncos` without relaxations against `ssas`, by both backends."""

import math
import time
from typing import Any

from bench.measure import Row, row
from bench.targets import TargetSet, reachable_set
from solver import solve
from solver.approach.task.task import approach_task
from solver.methods.registry import METHODS
from solver.problem.solution import Approach, Reason

WANTED_GAP = 1e-6
WANTED_MS = {"sqp": 2.0, "ipopt": 10.0}


def plan_each(targets: TargetSet, **options: Any) -> tuple[list[Approach], list[float]]:
    """Each target planned alone from the start posture, and how long it took [ms]."""
    problems = [
        targets[k : k + 1].problem(include=("path",), **options) for k in range(len(targets))
    ]
    solve(problems[0])
    approaches, times = [], []
    for problem in problems:
        began = time.perf_counter()
        plan = solve(problem)
        times.append(1e3 * (time.perf_counter() - began))
        approaches.append(plan.approaches[0])
    return approaches, times


def measure(quick: bool) -> list[Row]:
    """Gap to `ssas` and milliseconds a target for both backends."""
    targets = reachable_set(6, 5 if quick else 300)
    best = [approach.effort for approach in plan_each(targets, method="ssas")[0]]
    rows = []
    for backend, wanted_ms in WANTED_MS.items():
        approaches, plan_times = plan_each(targets, method="ncos", nlp_backend=backend)
        gaps = [
            abs(approach.effort - effort) / effort if approach.effort and effort else math.inf
            for approach, effort in zip(approaches, best, strict=True)
        ]
        kept = sum(one.solver.status.startswith("warm_start_after") for one in approaches)
        rows += [
            row(
                f"largest gap of {backend} to ssas, relative",
                max(gaps),
                "",
                runs=len(gaps),
                at_most=WANTED_GAP,
                note=f"the warm start was returned for {kept} targets",
            ),
            row(
                f"ncos by {backend}, warm start included",
                _method_times(targets, backend),
                "ms a target",
                at_most=wanted_ms,
                note="as `ncos` itself, before cut-in and verification",
            ),
            row(f"ncos by {backend}, verified plan", plan_times, "ms a target"),
        ]
    return rows


def _method_times(targets: TargetSet, backend: str) -> list[float]:
    problem = targets.problem(method="ncos", nlp_backend=backend)
    tasks = [approach_task(problem, target, problem.start) for target in problem.targets]
    times = []
    for task in tasks:
        began = time.perf_counter()
        outcome = METHODS["ncos"].solve(task)
        times.append(1e3 * (time.perf_counter() - began))
        assert not isinstance(outcome, Reason), "ssas has an approach, so ncos has one"
    return times
