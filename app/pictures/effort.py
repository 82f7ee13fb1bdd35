"""Effort against approach angle for each target, with the feasible arcs of every branch."""

from collections.abc import Mapping
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.pictures.references import planned_with_references
from solver import Problem
from solver.approach.arcs import Survey, survey_target

CHOSEN_COLOUR = "#e0457b"
BORDER_DEG = 20.0


def draw_effort(plan: Mapping[str, Any], problem: Problem) -> Figure:
    """One panel a planned target: a curve a branch where it is feasible, the choice marked."""
    steps = list(planned_with_references(plan, problem))
    surveys = [survey_target(problem, target, reference) for _, target, reference in steps]
    figure = Figure(figsize=(11, 1.2 + 2.1 * max(len(steps), 1)), layout="constrained")
    panels = figure.subplots(max(len(steps), 1), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (approach, _, _), survey in zip(panels, steps, surveys, strict=False):
        _draw_panel(axes, approach, survey)
    unit = "rad" if plan["options"]["norm"] == "l1" else "rad²"
    panels[-1].set_xlabel("approach angle about the branch [°]")
    panels[-1].set_xlim(*_angle_range(surveys))
    figure.supylabel(f"effort [{unit}]")
    figure.suptitle(
        "Effort against approach angle: curves where a branch is feasible in the whole cut-in, "
        "bars its arcs"
    )
    return figure


def _angle_range(surveys: list[Survey]) -> tuple[float, float]:
    """The angles at which anything is feasible, with a border, at most one turn [degrees]."""
    ends = [arc for survey in surveys for arc in survey.arcs]
    if not ends or max(arc.upper_rad for arc in ends) > np.pi:
        return -180.0, 180.0
    low = np.degrees(min(arc.lower_rad for arc in ends)) - BORDER_DEG
    high = np.degrees(max(arc.upper_rad for arc in ends)) + BORDER_DEG
    return max(low, -180.0), min(high, 180.0)


def _draw_panel(axes: Axes, approach: Mapping[str, Any], survey: Survey) -> None:
    feasible = [row for row in range(len(survey.curves)) if np.isfinite(survey.efforts[row]).any()]
    palette = matplotlib.colormaps["tab10"]
    degrees = np.degrees(survey.angles_rad)
    values = survey.efforts[np.isfinite(survey.efforts)]
    low, high = (values.min(), values.max()) if values.size else (0.0, 1.0)
    span = max(high - low, 1e-6)
    for row in feasible:
        side, branch = survey.curves[row]
        colour = palette(branch % 10)
        style = "-" if side == 1 else "--"
        axes.plot(degrees, survey.efforts[row], style, color=colour, label=f"branch {branch}")
        for arc in survey.arcs:
            if (arc.tool_side, arc.branch) != (side, branch):
                continue
            start, end = np.degrees((arc.lower_rad, arc.upper_rad))
            # An arc across the half turn is drawn at both ends of the axis.
            for turn in (0, -360):
                height = low - span * (0.10 + 0.035 * feasible.index(row))
                axes.plot(
                    (start + turn, end + turn),
                    (height, height),
                    color=colour,
                    linewidth=4,
                    solid_capstyle="butt",
                )
    angle = np.degrees(approach["approach_angle_rad"])
    axes.plot(angle, approach["effort"], "o", color=CHOSEN_COLOUR, markersize=9, zorder=5)
    axes.annotate(
        f"{angle:.2f}°, {approach['effort']:.3f}",
        (angle, approach["effort"]),
        textcoords="offset points",
        xytext=(0, 14),
        ha="center",
        color=CHOSEN_COLOUR,
    )
    axes.set_ylabel(f"target {approach['target_id']}")
    axes.grid(alpha=0.25)
    axes.legend(loc="upper left", fontsize=8, ncols=2)
    axes.margins(y=0.12)
