"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

SHORTEST_DIRECTION: Final = 1e-9
"""A branch direction shorter than this has no direction; directions may have any unit."""
