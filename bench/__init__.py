"""Benchmarks: `python -m bench`, one subject each, results as JSON, a page and plots from them.

Not installed with the project. Peers and reference solutions live here, never in the solver.
"""
