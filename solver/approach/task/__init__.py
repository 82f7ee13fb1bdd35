"""One target's task: its frame, its numbers for kernels, what is feasible, what answers it."""
