"""How far targets are from each other, against all pairs of nodes."""

import numpy as np
import pytest

from solver.sequencing.distances import nearest_next, target_distances
from tests.solver.sequencing.synthetic import layer, nodes, stage


@pytest.mark.parametrize("squared", [False, True])
def test_distances_are_the_least_of_all_pairs(squared: bool) -> None:
    of = nodes(8, (2, 3, 1), squared=squared)
    found = target_distances(of)
    assert found.shape == (4, 3)
    for k in range(3):
        assert found[3, k] == pytest.approx(min(stage(of, -1, m) for m in layer(of, k)))
        for j in range(3):
            least = min(stage(of, i, m) for i in layer(of, j) for m in layer(of, k))
            assert found[j, k] == pytest.approx(least)


def test_each_time_the_nearest_that_is_left_comes_next() -> None:
    distances = np.array(
        [[9.0, 1.0, 2.0, 2.0], [1.0, 9.0, 4.0, 3.0], [5.0, 0.5, 9.0, 4.0], [1.0, 1.0, 1.0, 9.0],
         [3.0, 3.0, 8.0, 2.0]]
    )  # fmt: skip
    assert nearest_next(distances).tolist() == [3, 0, 1, 2]
    distances[3, 1] = 0.5
    assert nearest_next(distances).tolist() == [3, 1, 0, 2]
