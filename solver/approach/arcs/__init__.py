"""Feasible arcs of the approach angle: the margins, their roots, the search for every arc."""
