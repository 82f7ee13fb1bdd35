"""Whose token it is, which scopes there are, how tokens look."""
