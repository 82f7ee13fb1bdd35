"""Batches: the ladder graph over every target's feasible arcs, and the order of targets."""
