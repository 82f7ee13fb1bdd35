"""The one verifier: residuals of every answer, recomputed from the problem."""
