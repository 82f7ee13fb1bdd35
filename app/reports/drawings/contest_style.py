"""What the pictures of a comparison share: how a method looks, and which targets are shown."""

from collections.abc import Sequence
from typing import Any, Final

import matplotlib

from solver import Target
from solver.comparison.result import Comparison

MARKERS: Final = ("o", "s", "^", "D", "v", "P", "*", "h", "<", ">")


def method_style(comparison: Comparison, method: str) -> dict[str, Any]:
    """Colour and marker of a method, the same in every picture of a comparison."""
    place = [summary.method for summary in comparison.summaries].index(method)
    colours = matplotlib.colormaps["tab10"]
    return {"color": colours(place % 10), "marker": MARKERS[place % len(MARKERS)]}


def shown_targets(
    comparison: Comparison, targets: Sequence[Target], most: int
) -> tuple[Target, ...]:
    """The targets that a picture has room for: the first ones that any method reaches.

    Where there are fewer than `most` of them, so many are shown; where none, the first targets.
    """
    reached = {row.target_id for row in comparison.rows if row.solved}
    if len(targets) <= most:
        return tuple(targets)
    return tuple([target for target in targets if target.id in reached] or targets)[:most]
