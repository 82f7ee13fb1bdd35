"""Timed motion: how a path becomes a trajectory inside the speed limits."""
