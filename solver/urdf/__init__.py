"""Robot models read from URDF and written to it."""
