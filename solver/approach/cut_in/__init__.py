"""The straight cut-in of a candidate, at its rows and between them."""
