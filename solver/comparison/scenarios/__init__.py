"""The scenarios, a file each, and what several of them share; `solver.comparison.registry` lists them."""
