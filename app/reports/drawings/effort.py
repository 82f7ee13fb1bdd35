"""Effort against approach angle for each target, with the feasible arcs of every branch."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.reports.drawings.labels import plain_text
from app.reports.drawings.references import planned_with_references
from solver import Arc, Problem, Robot, Survey, survey_target

CHOSEN_COLOUR = "#e0457b"
BORDER_DEG = 20.0
# In shares of the range of efforts, below the least effort.
BARS_BELOW, BAR_STEP = 0.10, 0.08


def draw_effort(plan: Mapping[str, Any], problem: Problem) -> Figure:
    """One panel a planned target: a curve a branch where it is feasible, the choice marked."""
    steps = list(planned_with_references(plan, problem))
    surveys = [survey_target(problem, target, reference) for _, target, reference in steps]
    figure = Figure(figsize=(11, 1.2 + 2.1 * max(len(steps), 1)), layout="constrained")
    panels = figure.subplots(max(len(steps), 1), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (approach, _, _), survey in zip(panels, steps, surveys, strict=False):
        _draw_panel(axes, approach, survey, problem.robot)
    unit = "rad" if plan["options"]["norm"] == "l1" else "rad²"
    panels[-1].set_xlabel("approach angle about the branch [°]")
    panels[-1].set_xlim(*angle_range(surveys))
    figure.supylabel(f"effort [{unit}]")
    figure.suptitle(
        "Effort against approach angle: curves where a branch is feasible in the whole cut-in, "
        "bars its arcs,\nwith what ends them: a joint (q1 is the first), the reach, a jump of the "
        "wrist, or uncertainty"
    )
    return figure


def angle_range(surveys: Sequence[Survey]) -> tuple[float, float]:
    """The angles at which anything is feasible, with a border, at most one turn [degrees]."""
    ends = [arc for survey in surveys for arc in survey.arcs]
    if not ends or max(arc.upper_rad for arc in ends) > np.pi:
        return -180.0, 180.0
    low = np.degrees(min(arc.lower_rad for arc in ends)) - BORDER_DEG
    high = np.degrees(max(arc.upper_rad for arc in ends)) + BORDER_DEG
    return max(low, -180.0), min(high, 180.0)


def draw_curves(axes: Axes, survey: Survey, robot: Robot) -> None:
    """Effort over the angle, a curve a branch where it is feasible, and a bar for each arc."""
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
            height = low - span * (BARS_BELOW + BAR_STEP * feasible.index(row))
            _draw_arc(axes, arc, height, colour, robot)
    axes.grid(alpha=0.25)
    axes.margins(y=0.12)


def _draw_panel(axes: Axes, approach: Mapping[str, Any], survey: Survey, robot: Robot) -> None:
    draw_curves(axes, survey, robot)
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
    axes.set_ylabel(plain_text(f"target {approach['target_id']}"))
    axes.legend(loc="upper left", fontsize=8, ncols=2)


def _draw_arc(axes: Axes, arc: Arc, height: float, colour: Any, robot: Robot) -> None:
    """A bar over the arc's angles; one across the half turn is drawn at both ends of the axis."""
    start, end = np.degrees((arc.lower_rad, arc.upper_rad))
    for turn in (0, -360):
        at = (start + turn, end + turn)
        axes.plot(at, (height, height), color=colour, linewidth=4, solid_capstyle="butt")
        for angle, limit, side in (
            (at[0], arc.lower_limit, "right"),
            (at[1], arc.upper_limit, "left"),
        ):
            axes.annotate(
                _short(limit, robot),
                (angle, height),
                textcoords="offset points",
                xytext=(3 if side == "left" else -3, 0),
                ha=side,
                va="center_baseline",
                color=colour,
                fontsize=7,
                annotation_clip=True,
            )


def _short(limit: str | None, robot: Robot) -> str:
    """What ends an arc, in a word: a joint by its number."""
    if limit in robot.joint_names:
        return f"q{robot.joint_names.index(limit) + 1}"
    return {None: "", "wrist_jump": "jump"}.get(limit, limit or "")
