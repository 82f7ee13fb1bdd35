"""Servos as data, and the one place that knows both ticks and radians."""
