"""Proven bounds: interval arithmetic, the closed form enclosed, branch and bound."""
