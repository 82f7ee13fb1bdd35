import numpy as np
import pytest

from solver import Robot
from solver.sequencing.ladder_graph import refined_ladder
from solver.sequencing.polish import polished
from tests.solver.problems import random_targets
from tests.solver.sequencing.batches import batch_of


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_every_round_and_the_polish_only_gain(tabletop: Robot, norm: str) -> None:
    batch, targets = batch_of(tabletop, random_targets(seed=65, count=60), norm=norm)
    order = np.arange(len(targets))
    efforts = []
    for rounds in range(4):
        arcs, angles, effort = refined_ladder(batch, order, 0.1, 8, rounds)
        efforts.append(effort)
    assert efforts == sorted(efforts, reverse=True)
    moved, gained = polished(batch, arcs, angles)
    assert gained < efforts[-1]
    assert np.all((batch.arc_lower[arcs] <= moved) & (moved <= batch.arc_upper[arcs]))
