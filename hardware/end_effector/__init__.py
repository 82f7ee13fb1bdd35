"""The end-effectors, a row each, and the guard process that owns their output."""
