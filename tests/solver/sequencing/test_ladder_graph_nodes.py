"""The nodes of a ladder graph: even ones, those kept, and their halves; by hand."""

import itertools

import numpy as np
import pytest

from solver.problem.options import Norm
from solver.sequencing.batch import arc_postures
from solver.sequencing.ladder_graph import (
    _carried,
    even_nodes,
    halved,
    kept_nodes,
    node_angle,
    node_angles,
    refined_ladder,
)
from tests.solver.sequencing.synthetic import batch, cost


def test_arcs_are_divided_evenly_ends_included() -> None:
    of = batch(half_rad=0.1)
    layers, arcs, places, pieces = even_nodes(of, np.array([2, 0]), 0.032)
    # 0.1 in four pieces, 0.09 in three.
    assert layers.tolist() == [0, 9, 18]
    assert arcs.tolist() == [4] * 5 + [5] * 4 + [0] * 5 + [1] * 4
    assert places.tolist() == [*range(5), *range(4)] * 2
    assert pieces.tolist() == ([4] * 5 + [3] * 4) * 2
    angles = node_angles(of, arcs, places, pieces)
    for n, angle in enumerate(angles):
        low, high = of.arc_lower[arcs[n]], of.arc_upper[arcs[n]]
        assert angle == pytest.approx(low + (high - low) * places[n] / pieces[n], abs=1e-15)
    assert node_angle(of, 0, 4, 4) == of.arc_upper[0]
    assert node_angle(of, 0, 0, 4) == of.arc_lower[0]


def test_short_arcs_have_two_pieces_and_one_without_length_a_node() -> None:
    of = batch(half_rad=0.1)
    upper = of.arc_upper.copy()
    upper[1] = of.arc_lower[1]
    layers, arcs, places, pieces = even_nodes(of._replace(arc_upper=upper), np.array([0]), 5.0)
    assert layers.tolist() == [0, 4]
    assert arcs.tolist() == [0, 0, 0, 1]
    assert places.tolist() == [0, 1, 2, 0]
    assert pieces.tolist() == [2, 2, 2, 0]
    assert node_angle(of, 1, 0, 0) == of.arc_upper[1]


def test_the_cheapest_of_each_layer_are_kept_and_ties() -> None:
    through = np.array([3.0, 1.0, 2.0, 2.0, 9.0, 5.0, 4.0])
    kept = kept_nodes(through, np.array([0, 5, 7]), 2)
    assert kept.tolist() == [False, True, True, True, False, True, True]
    kept = kept_nodes(through, np.array([0, 5, 7]), 1)
    assert kept.tolist() == [False, True, False, False, False, False, True]


def test_what_is_kept_gets_its_halves_beside_it() -> None:
    layers, arcs = np.array([0, 5, 7]), np.array([0, 0, 0, 1, 1, 2, 2])
    places, pieces = np.array([0, 1, 2, 0, 1, 1, 2]), np.array([2, 2, 2, 2, 2, 2, 2])
    kept = np.array([True, True, False, False, True, False, True])
    layers, arcs, places, pieces, origins = halved(kept, layers, arcs, places, pieces)
    assert layers.tolist() == [0, 7, 9]
    assert arcs.tolist() == [0, 0, 0, 0, 1, 1, 1, 2, 2]
    assert places.tolist() == [0, 1, 2, 3, 1, 2, 3, 3, 4]
    assert pieces.tolist() == [4] * 9
    assert origins.tolist() == [0, -1, 1, -1, -1, 4, -1, -1, 6]


def test_postures_that_are_known_are_carried_on() -> None:
    of = batch(count=1)
    arcs, angles = np.array([0, 0, 1, 1]), of.arc_lower[[0, 0, 1, 1]] + np.array([0, 0.02, 0, 0.03])
    expected, ends = np.empty((6, 4)), np.empty((6, 4))
    arc_postures(of, arcs, angles, expected, ends)
    known = np.array([2, 0])
    thinning, standby = _carried(
        of, arcs, angles, np.array([1, -1, 0, -1]), expected[:, known], ends[:, known]
    )
    assert thinning == pytest.approx(expected)
    assert standby == pytest.approx(ends)
    # Copied, and not computed again.
    thinning, _ = _carried(of, arcs, angles, np.array([1, -1, 0, -1]), 0 * expected, 0 * ends)
    assert np.all(thinning[:, [0, 2]] == 0.0)
    assert thinning[:, [1, 3]] == pytest.approx(expected[:, [1, 3]])


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_a_ladder_has_the_least_of_all_chains_and_no_round_is_dearer(norm: Norm) -> None:
    of = batch(norm)
    order = np.array([1, 2, 0])
    layers, arcs, places, pieces = even_nodes(of, order, 0.06)
    angles = node_angles(of, arcs, places, pieces)
    thinning, standby = np.empty((6, len(arcs))), np.empty((6, len(arcs)))
    arc_postures(of, arcs, angles, thinning, standby)
    least = np.inf
    for chain in itertools.product(*(range(layers[k], layers[k + 1]) for k in range(3))):
        before, total = of.start, 0.0
        for n in chain:
            total += cost(thinning[:, n] - before, squared=norm == "l2")
            before = standby[:, n]
        least = min(least, total)
    efforts = []
    for rounds in range(3):
        own_arcs, own_angles, effort = refined_ladder(of, order, 0.06, 4, rounds)
        assert (own_arcs // 2).tolist() == order.tolist()
        assert np.all(of.arc_lower[own_arcs] <= own_angles)
        assert np.all(own_angles <= of.arc_upper[own_arcs])
        thinning, standby = np.empty((6, 3)), np.empty((6, 3))
        arc_postures(of, own_arcs, own_angles, thinning, standby)
        before = np.column_stack((of.start, standby[:, :2]))
        assert effort == pytest.approx(cost(thinning - before, squared=norm == "l2"), rel=1e-12)
        efforts.append(effort)
    assert efforts[0] == pytest.approx(least, rel=1e-12)
    assert efforts == sorted(efforts, reverse=True)
    assert norm == "l2" or efforts[-1] < efforts[0]
