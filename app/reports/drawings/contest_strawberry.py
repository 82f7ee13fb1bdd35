"""The strawberry mechanism as a comparison's methods place it."""

from typing import Final

from matplotlib.figure import Figure

from app.reports.drawings.strawberry import SHOWN, draw_poses
from solver.comparison.result import Comparison
from solver.comparison.strawberry.mechanism import Posture
from solver.comparison.strawberry.table_3 import table_3

MISSING: Final = "No target of this comparison has an answer."


def draw_strawberry(comparison: Comparison) -> Figure:
    """The poses at the target at which most of the paper's methods have one, the first of these."""
    rows = [row for row in comparison.rows if row.solved and row.method in SHOWN]
    reached = {
        target.label: [row for row in rows if row.target_id == target.label] for target in table_3()
    }
    label, answers = max(reached.items(), key=lambda entry: len(entry[1]))
    (place,) = [target.target for target in table_3() if target.label == label]
    postures = {row.method: Posture(*row.joints) for row in answers if row.joints is not None}
    if not postures:
        figure = Figure(figsize=(6, 1))
        figure.text(0.5, 0.5, MISSING, ha="center", va="center")
        return figure
    return draw_poses(place, postures)
