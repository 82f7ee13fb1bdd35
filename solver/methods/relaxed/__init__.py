"""Relaxed tasks: a ladder of zones, the closed form in them, and the programme from its best."""
