"""Other ways through a batch, for benchmarks and tests: even angles, and from target to target."""

import numpy as np

from solver.approach.arcs.arcs import sample_task
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.packing import packed_problem
from solver.approach.task.task import approach_task
from solver.problem.problem import Problem
from solver.problem.retreats import even_retreats
from solver.problem.solution import Arc
from solver.sequencing.gather import gather
from solver.sequencing.ladder_graph import refined_ladder


def even_ladder_effort(problem: Problem, angles: int) -> tuple[float, int]:
    """Total effort and number of targets of a ladder graph over even angles with straight cut-ins.

    What Tesseract's Descartes does: approach angles phi_k = -pi + 2 pi k / n, all branches, those
    kept whose whole cut-in is feasible, then the cheapest chain. Targets without such an angle are
    left out: their number tells whether two efforts may be compared.
    """
    tasks, arcs, reached = [], [], []
    for k, target in enumerate(problem.targets):
        task = approach_task(problem, target, problem.start)
        own = []
        for side in task.tool_sides:
            sampled, margins, _ = sample_task(task, side, angles)
            own += [
                Arc(side, int(branch), float(sampled[k]), float(sampled[k]))
                for branch, k in zip(*(margins >= 0).nonzero(), strict=True)
            ]
        if own:
            tasks.append(task)
            arcs.append(own)
            reached.append(k)
    if not tasks:
        return 0.0, 0
    batch = gather(problem, packed_problem(problem)[:, reached], arcs)
    effort = refined_ladder(batch, np.arange(len(tasks)), 1.0, 1, 0)[2]
    return float(effort), len(tasks)


def greedy_effort(problem: Problem) -> float:
    """Total effort of going from target to target, each time with the least effort for it alone."""
    reference, total = problem.start, 0.0
    ends = even_retreats(problem.options, 2)
    for target in problem.targets:
        task = approach_task(problem, target, reference)
        best = best_on_arcs(task)
        if best is None:
            continue
        total += best.effort
        rows = task.postures(best.angle_rad, best.arc.tool_side, best.arc.branch, ends)
        reference = tuple(float(value) for value in rows[0])
    return total
