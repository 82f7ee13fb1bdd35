import numpy as np
import pytest

from bench.order_search import efforts_of_orders, long_search
from bench.reference import build_ladder, ladder_effort
from bench.targets import reachable_set

ANGLES = 36


def test_every_order_has_the_effort_of_its_ladder_graph() -> None:
    targets = reachable_set(5, 4)
    problem = targets.problem()
    orders, efforts = efforts_of_orders(problem, build_ladder(problem, targets, ANGLES))
    assert len({tuple(order) for order in orders.tolist()}) == 24
    assert np.all(np.diff(efforts) >= 0)
    for order, effort in zip(orders, efforts, strict=True):
        ladder = build_ladder(problem, targets[order], ANGLES)
        assert ladder_effort(problem, ladder) == pytest.approx(effort, rel=1e-12)


def test_a_long_search_finds_the_best_order_of_few_targets() -> None:
    targets = reachable_set(5, 6)
    problem = targets.problem()
    ladder = build_ladder(problem, targets, ANGLES)
    order = long_search(problem, ladder, seconds=0.3, seed=1)
    assert sorted(order) == list(range(6))
    _, efforts = efforts_of_orders(problem, ladder)
    found = ladder_effort(problem, build_ladder(problem, targets[order], ANGLES))
    assert found == pytest.approx(efforts[0], rel=1e-12)
