"""The one verifier: a residual for each thing that is promised, from the problem alone."""
