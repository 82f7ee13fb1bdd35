import numpy as np

from bench.reference import sweep_targets
from bench.targets import data_set_3, feasible, hard_set, random_set, reachable_set, together


def test_sets_are_the_same_every_time() -> None:
    for draw in (random_set, hard_set, reachable_set):
        one, two = draw(5, 30), draw(5, 30)
        assert len(one) == 30
        assert np.array_equal(one.positions, two.positions)
        assert np.array_equal(one.directions, two.directions)
        assert not np.array_equal(one.positions, draw(6, 30).positions)


def test_reachable_targets_can_be_reached() -> None:
    assert feasible(reachable_set(5, 40)).all()
    assert feasible(data_set_3()).all()


def test_hard_targets_are_reached_or_refused_as_by_a_sweep() -> None:
    """Half of them lose their cut-in; no target that a sweep reaches is missed."""
    targets = hard_set(7, 60)
    swept = np.isfinite(sweep_targets(targets.problem(), targets, 2048).at_rows)
    assert 20 < np.count_nonzero(swept) < 60
    assert np.all(feasible(targets)[swept])


def test_sets_together_keep_their_order() -> None:
    one, two = random_set(1, 3), random_set(2, 4)
    both = together(one, two)
    assert len(both) == 7
    assert np.array_equal(both[3:].positions, two.positions)
