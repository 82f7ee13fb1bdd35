"""Pydantic models of the wire, used at the edge only."""
