"""Frames other than the base: poses, pairs of points, registration."""
