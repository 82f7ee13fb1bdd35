"""One target's task definition: its frame, its numbers for kernels, what a method answers."""
