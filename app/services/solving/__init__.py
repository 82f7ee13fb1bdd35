"""Where solving runs: the pool of solver processes, one of them, what it is given to do."""
