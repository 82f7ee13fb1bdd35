"""Nodes and batches of a few numbers, small enough for kernels that are interpreted."""

from collections.abc import Iterator, Sequence

import numpy as np

from solver import Arc, Options, Problem, load_robot
from solver.approach.task.packing import packed_problem
from solver.problem.options import Norm
from solver.robots.model import Array
from solver.sequencing.batch import Batch
from solver.sequencing.gather import gather
from solver.sequencing.ordering import Nodes
from tests.solver.problems import DATA_SET_3

# Of data set 3, approaches well inside the arcs of branch 2.
ANGLES = (0.1, 0.15, -0.9, -0.95, -1.0)


def nodes(seed: int, sizes: Sequence[int], *, squared: bool = False) -> Nodes:
    """Random postures, so many for each target."""
    rng = np.random.default_rng(seed)
    count = sum(sizes)
    thinning, standby = rng.uniform(-1.0, 1.0, (2, 6, count))
    return Nodes(
        start=rng.uniform(-1.0, 1.0, (6, 1)),
        thinning=thinning,
        standby=standby,
        thinning_rows=np.ascontiguousarray(thinning.T),
        standby_rows=np.ascontiguousarray(standby.T),
        first=np.cumsum([0, *sizes]),
        squared=squared,
    )


def cost(change: Array, *, squared: bool) -> float:
    return float(np.sum(change * change if squared else np.abs(change)))


def stage(of: Nodes, before: int, node: int) -> float:
    """From the standby of a node, or the start (-1), to the thinning posture of another."""
    left = of.start[:, 0] if before < 0 else of.standby[:, before]
    return cost(of.thinning[:, node] - left, squared=of.squared)


def effort(of: Nodes, chain: Sequence[int]) -> float:
    return sum(stage(of, before, node) for before, node in zip((-1, *chain), chain, strict=False))


def layer(of: Nodes, target: int) -> range:
    return range(int(of.first[target]), int(of.first[target + 1]))


def chains(of: Nodes, order: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All chains of nodes, one for each target of an order."""
    if not order:
        yield ()
        return
    for chain in chains(of, order[:-1]):
        for node in layer(of, order[-1]):
            yield (*chain, node)


def best(of: Nodes, order: Sequence[int]) -> float:
    """The least effort of an order."""
    return min(effort(of, chain) for chain in chains(of, order))


def batch(
    norm: Norm = "l1", half_rad: float = 0.1, count: int = 3, weights: Sequence[float] | None = None
) -> Batch:
    """The first targets of data set 3, each with two pieces of an arc."""
    targets = DATA_SET_3[:count]
    options = Options(norm=norm, joint_weights=weights)
    problem = Problem(load_robot("tabletop"), targets, options)
    arcs = [
        (Arc(1, 2, angle - half_rad, angle), Arc(1, 2, angle + 0.01, angle + half_rad))
        for angle in ANGLES[:count]
    ]
    return gather(problem, packed_problem(problem), arcs)
