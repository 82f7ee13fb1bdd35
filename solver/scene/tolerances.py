"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

BOX_HALVINGS: Final = 45
"""How often the nearest point of a segment to a box is closed in on: 1e-14 of its length."""

DIRECT_CAPSULES: Final = 400
"""Up to so many capsules of obstacles each is looked at, eight at once; more are put in a grid."""

GRID_CELLS: Final = 32
"""Cells of the grid along its longest edge: 3 to 4 cm for an arm of this size. Finer ones leave the
processor's cache, which costs more than it saves that fewer things are in each."""

GRID_STEP_CELLS: Final = 2.0
"""Length of a link that is looked at together near obstacles [cells]."""

INSIDE_STEPS: Final = 60
"""Steps of the search for the deepest point of a segment inside a box (golden section)."""

GUESSED_ITEMS: Final = 4
"""So many things of a cell are looked at for a first guess of what is nearest: one of them is as
good as any."""

LEAST_FREE_CELLS: Final = 0.2
"""A link's axis is not gone along in shorter steps; what is around is looked at then [cells]."""
