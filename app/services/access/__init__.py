"""Whose token it is, what it allows, and how tokens look."""
