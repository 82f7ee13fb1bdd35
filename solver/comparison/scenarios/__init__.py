"""What methods are compared on: a file a scenario, listed in `solver.comparison.registry`."""
