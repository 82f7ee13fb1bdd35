"""Calibration files that ship: zero for each arm, and the thesis's own as an example."""
