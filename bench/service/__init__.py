"""Benchmarks and trials of the live service, against processes of their own."""
