"""Transfers: the way from one standby posture to the next, a file a planner."""
