"""The approach about the branch: its frame, its feasibility and its feasible arcs."""
