"""The worker: its loop, orders checked and carried out, faults, the safe state, its program."""
