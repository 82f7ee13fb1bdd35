"""The scenarios, a file each; `solver.comparison.registry` lists them."""
