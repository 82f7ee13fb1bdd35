"""Families of arms by the inverse that they have: a file each, and a row each in the registry."""
