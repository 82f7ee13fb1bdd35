"""Scenarios: what is compared, a file each."""
