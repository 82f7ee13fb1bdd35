"""Mutants of the rooms that decide: what changes there does no test notice? `make mutants`."""
