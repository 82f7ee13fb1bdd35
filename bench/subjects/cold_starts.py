"""What the warm start is worth: the programme of `ncos` from random starts."""

import numpy as np

from bench.measure import Row, row
from bench.subjects.ncos import plan_each
from bench.targets import reachable_set
from solver.approach.task.task import approach_task

AS_CHEAP = 1e-3
STARTS = (1, 8)


def measure(quick: bool) -> list[Row]:
    """Share solved and milliseconds a target, by backend and number of starts."""
    from solver.comparison.cold_start import cold_solve

    targets = reachable_set(8, 3 if quick else 100)
    warm, warm_times = plan_each(targets, method="ncos")
    rows = [row("ncos, warm start by ssas, verified plan", warm_times, "ms a target")]
    for backend in ("ipopt", "sqp"):
        problem = targets.problem(method="ncos", nlp_backend=backend)
        tasks = [approach_task(problem, target, problem.start) for target in problem.targets]
        for starts in STARTS:
            results = [cold_solve(task, backend, starts, seed) for seed, task in enumerate(tasks)]
            as_cheap = [
                result.success and result.effort <= (approach.effort or 0.0) * (1 + AS_CHEAP)
                for result, approach in zip(results, warm, strict=True)
            ]
            label = f"{backend} from {starts} random start{'s' if starts > 1 else ''}"
            rows += [
                row(
                    f"{label}, solved",
                    100 * float(np.mean([result.success for result in results])),
                    "%",
                    runs=len(results),
                    note="thinning and standby hold; the cut-in is not looked at",
                ),
                row(
                    f"{label}, solved as cheaply as from the warm start",
                    100 * float(np.mean(as_cheap)),
                    "%",
                    runs=len(results),
                    note=f"within {100 * AS_CHEAP:g} %",
                ),
                row(label, [1e3 * result.elapsed_s for result in results], "ms a target"),
            ]
    return rows
