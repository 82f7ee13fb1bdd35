"""Batches as one: the ladder graph over feasible arcs, its refinement, the order of targets."""
