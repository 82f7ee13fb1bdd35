"""Robots: a model file each, and what reads them."""
