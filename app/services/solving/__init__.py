"""Solver processes: one, the pool, what the service has them do."""
