"""Calibrations that ship: a file of zeros a robot, and the thesis's own as an example."""
