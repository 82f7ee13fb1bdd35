import itertools

import numpy as np
import pytest

from solver import Robot
from solver.sequencing.ladder_graph import refined_ladder
from solver.sequencing.ordering import coarse_nodes
from tests.solver.problems import random_targets
from tests.solver.sequencing.batches import batch_of


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_unrefined_ladder_is_the_cheapest_of_all_chains(tabletop: Robot, norm: str) -> None:
    batch, targets = batch_of(tabletop, random_targets(seed=61, count=12), norm=norm)
    order = np.arange(min(3, len(targets)))
    nodes = coarse_nodes(batch, 0.5)
    layers = [range(nodes.first[k], nodes.first[k + 1]) for k in order]
    best = np.inf
    for chain in itertools.product(*layers):
        before, total = nodes.start[:, 0], 0.0
        for n in chain:
            change = np.abs(nodes.thinning[:, n] - before)
            total += float((change**2 if nodes.squared else change).sum())
            before = nodes.standby[:, n]
        best = min(best, total)
    assert len(order) == 3
    _, _, effort = refined_ladder(batch, order, 0.5, 16, 0)
    assert effort == pytest.approx(best, rel=1e-12)
