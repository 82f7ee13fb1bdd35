"""Least effort over the feasible arcs, for one target and for many at once."""
