"""Whose token it is, what it allows (a row a route in `scopes.py`), how tokens look."""
