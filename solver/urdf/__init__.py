"""Robots in and out of URDF."""
