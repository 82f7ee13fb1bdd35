"""Table 3 of S as data: 20 targets, indices and processor times, from MATLAB R2009a.

The origin of `table_3.csv` is the table as printed, column by column; nothing in it is computed.
Its targets lie on a sphere of 100 mm about (500, 367.5, -395) mm, S's plant, with z to a tenth of a
millimetre (docs/strawberry.md).
"""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Final

from solver.comparison.strawberry.mechanism import Point

METHODS: Final = ("ncos", "ssas", "as")
MACHINE: Final = "Intel Core i7 920, 2.67 GHz, 6 GB, MATLAB R2009a (S section 4)"

PLANT_CENTRE_M: Final[Point] = (0.5, 0.3675, -0.395)
"""Centre of the sphere on which the printed targets lie, found from them; S prints none [m]."""

PLANT_RADIUS_M: Final = 0.1
"""Its radius, found with the centre; S prints none [m]."""


@dataclass(frozen=True)
class Row:
    """One target of Table 3.

    Attributes:
        target: x, y, z in F0 [m].
        label: x, y, z as printed [mm].
        index_n_mm: printed index by method [N mm].
        time_s: printed processor time by method [s].
        increase_pct: printed increase of the index over NCOS's, by method [%].
        reduction_pct: printed reduction of the time against NCOS's, by method [%].
    """

    target: Point
    label: str
    index_n_mm: dict[str, float]
    time_s: dict[str, float]
    increase_pct: dict[str, float]
    reduction_pct: dict[str, float]


@lru_cache(maxsize=1)
def table_3() -> tuple[Row, ...]:
    """The rows in the order printed."""
    text = (resources.files("solver.comparison.strawberry") / "table_3.csv").read_text(
        encoding="utf-8"
    )
    return tuple(_row(entry) for entry in csv.DictReader(text.splitlines()))


def _row(entry: dict[str, str]) -> Row:
    x, y, z = (entry[f"{axis}_mm"] for axis in "xyz")
    return Row(
        (float(x) * 1e-3, float(y) * 1e-3, float(z) * 1e-3),
        f"{x} {y} {z}",
        {name: float(entry[f"{name}_index"]) for name in METHODS},
        {name: float(entry[f"{name}_cpu_s"]) for name in METHODS},
        {name: float(entry[f"{name}_increase_pct"]) for name in METHODS[1:]},
        {name: float(entry[f"{name}_cpu_reduction_pct"]) for name in METHODS[1:]},
    )
