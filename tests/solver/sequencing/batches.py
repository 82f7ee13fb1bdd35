"""Batches that tests of sequencing use, and a plain search through one."""

import numpy as np

from solver import Options, Problem, Robot, Target
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.task.packing import packed_problem
from solver.sequencing.batch import Batch
from solver.sequencing.gather import gather
from solver.sequencing.ordering import coarse_nodes


def batch_of(robot: Robot, targets: list[Target], **options: object) -> tuple[Batch, list[Target]]:
    """The batch of those targets that have an arc, and those targets."""
    problem = Problem(robot, targets, options=Options(**options))  # type: ignore[arg-type]
    found = feasible_arcs(problem)
    reached = [k for k, target in enumerate(targets) if found[target.id]]
    arcs = [found[targets[k].id] for k in reached]
    batch = gather(problem, packed_problem(problem)[:, reached], arcs)
    return batch, [targets[k] for k in reached]


def plain_ladder(batch: Batch, order: list[int], step: float) -> float:
    """The ladder of even angles written out with NumPy."""
    nodes = coarse_nodes(batch, step)
    reached, before = np.zeros(1), nodes.start
    for k in order:
        own = slice(nodes.first[k], nodes.first[k + 1])
        change = np.abs(nodes.thinning[:, None, own] - before[:, :, None])
        efforts = (change**2 if nodes.squared else change).sum(axis=0)
        reached, before = (reached[:, None] + efforts).min(axis=0), nodes.standby[:, own]
    return float(reached.min())
