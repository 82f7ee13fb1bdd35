"""Comparisons of methods: taken on, run one after the other in a solver process, kept."""
