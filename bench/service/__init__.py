<<<<<<< HEAD
"""Benchmarks and trials of the live service, against processes of their own."""
=======
"""The service measured from a second process: load, and what else is thrown at it."""
>>>>>>> main
