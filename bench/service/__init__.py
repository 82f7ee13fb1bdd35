"""The service measured from a second process: load, and what else is thrown at it."""
