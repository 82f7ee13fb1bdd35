"""Effort against approach angle with the arcs of every branch, and what each method chose."""

from typing import Final

import numpy as np
from matplotlib.figure import Figure

from app.reports.drawings.contest_style import method_style, shown_targets
from app.reports.drawings.effort import angle_range, draw_curves
from app.reports.drawings.labels import plain_text
from solver import (
    Problem,
    Target,
    approach_frame,
    family_of,
    forward_kinematics,
    placement,
    survey_target,
)
from solver.comparison.result import Comparison, Row

MOST_PANELS: Final = 6


def can_draw_effort(problem: Problem) -> bool:
    """Whether there are arcs to draw: efforts count from the start, and the arm has branches."""
    independent = problem.options.order == "independent" or len(problem.targets) == 1
    return independent and family_of(problem.robot, problem.mounted_tool).has_closed_form


def draw_contest_effort(comparison: Comparison, problem: Problem) -> Figure:
    """One panel a target, for MOST_PANELS of them at most."""
    targets = shown_targets(comparison, problem.targets, MOST_PANELS)
    surveys = [survey_target(problem, target, problem.start) for target in targets]
    figure = Figure(figsize=(11, 1.3 + 2.3 * len(targets)), layout="constrained")
    panels = figure.subplots(len(targets), 1, sharex=True, squeeze=False)[:, 0]
    for axes, target, survey in zip(panels, targets, surveys, strict=True):
        draw_curves(axes, survey, problem.robot)
        for row in comparison.rows:
            if row.target_id != target.id or row.joints is None or row.index is None:
                continue
            axes.plot(
                np.degrees(_angle(problem, target, row)),
                row.index,
                linestyle="none",
                markersize=10,
                markeredgecolor="black",
                markerfacecolor="none" if row.method != comparison.reference else None,
                zorder=5,
                label=plain_text(row.method) if axes is panels[0] else None,
                **method_style(comparison, row.method),
            )
        axes.set_ylabel(plain_text(f"target {target.id}"))
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, frameon=False)
    panels[-1].set_xlabel("approach angle about the branch [°]")
    panels[-1].set_xlim(*angle_range(surveys))
    figure.supylabel(comparison.index_name.replace("$", r"\$"))
    return figure


def _angle(problem: Problem, target: Target, row: Row) -> float:
    """The approach angle of a row's posture [rad]."""
    frame = approach_frame(target.position_m, target.branch_direction)
    pose = forward_kinematics(problem.robot, problem.mounted_tool, np.array(row.joints))
    side = 1 if float(pose[:3, 1] @ frame.branch) >= 0 else -1
    return placement(frame, np.asarray(target.position_m), side, pose).approach_angle_rad
