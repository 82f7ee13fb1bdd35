"""Motion in time: how a path becomes a trajectory inside the speed limits."""
