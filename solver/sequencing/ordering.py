"""Order and approaches of targets chosen together: a generalised travelling-salesman problem."""

from typing import NamedTuple

import numpy as np

from solver.robots.model import Array
from solver.sequencing.annealing import anneal, choose_between
from solver.sequencing.batch import Batch, Indices, arc_postures
from solver.sequencing.distances import nearest_next, target_distances
from solver.sequencing.exhaustive import cheapest_orders
from solver.sequencing.ladder_graph import even_nodes, node_angles
from solver.sequencing.tolerances import (
    ANNEAL_NEIGHBOURS,
    ANNEAL_STEP_RAD,
    ANNEAL_TRIALS,
    EXACT_ORDERS_KEPT,
    EXACT_STEP_RAD,
    EXACT_TARGETS,
)


class Nodes(NamedTuple):
    """Approaches that a search chooses from, by target; postures are scaled as in `Batch`.

    Attributes:
        start: start posture, shape (6, 1).
        thinning: thinning postures, shape (6, nodes).
        standby: standby postures, shape (6, nodes).
        thinning_rows: the same, shape (nodes, 6): the values of one posture lie together.
        standby_rows: the same, shape (nodes, 6).
        first: target k has the nodes first[k] up to first[k + 1], shape (targets + 1,).
        squared: the norm is l2.
    """

    start: Array
    thinning: Array
    standby: Array
    thinning_rows: Array
    standby_rows: Array
    first: Indices
    squared: bool


def orders_worth_refining(batch: Batch, seed: int) -> list[Indices]:
    """Orders of all targets of a batch, best on a coarse ladder first.

    Up to EXACT_TARGETS targets every order is counted, exactly on the coarse nodes, and the best
    few are returned, because refined approaches may turn the tables. Above, one order is searched.
    """
    targets = len(batch.first_arc) - 1
    if targets == 1:
        return [np.zeros(1, dtype=np.int64)]
    if targets <= EXACT_TARGETS:
        nodes = coarse_nodes(batch, EXACT_STEP_RAD)
        return list(cheapest_orders(nodes, EXACT_ORDERS_KEPT))
    return [searched_order(coarse_nodes(batch, ANNEAL_STEP_RAD), targets, seed)]


def coarse_nodes(batch: Batch, step: float) -> Nodes:
    """Nodes of every target, arcs divided into pieces of `step` at most [rad]."""
    targets = len(batch.first_arc) - 1
    first, arcs, places, pieces = even_nodes(batch, np.arange(targets), step)
    angles = node_angles(batch, arcs, places, pieces)
    thinning, standby = np.empty((6, len(arcs))), np.empty((6, len(arcs)))
    arc_postures(batch, arcs, angles, thinning, standby)
    return Nodes(
        start=np.ascontiguousarray(batch.start.reshape(6, 1)),
        thinning=thinning,
        standby=standby,
        thinning_rows=np.ascontiguousarray(thinning.T),
        standby_rows=np.ascontiguousarray(standby.T),
        first=first,
        squared=bool(batch.squared),
    )


def searched_order(
    nodes: Nodes, targets: int, seed: int, trials_a_target: int = ANNEAL_TRIALS
) -> Indices:
    """The order that annealing ends with, from the nearest target to the next nearest."""
    distances = target_distances(nodes)
    order = nearest_next(distances)
    chosen = nodes.first[order].copy()
    choose_between(nodes, order, chosen, 0, targets - 1, np.empty(nodes.thinning.shape[1]))
    between = distances[:targets].copy()
    np.fill_diagonal(between, np.inf)
    most = min(ANNEAL_NEIGHBOURS, targets - 1)
    neighbours = np.ascontiguousarray(np.argsort(between.T, axis=1, kind="stable")[:, :most])
    trials = trials_a_target * targets
    return np.asarray(anneal(nodes, order, chosen, neighbours, trials, seed)[0])
