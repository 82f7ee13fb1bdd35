"""Uncertain targets: how far one may move, and the approaches that bear it."""
