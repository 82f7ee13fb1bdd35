"""The poses of each method side by side."""

import math
from typing import Final

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]

from app.reports.drawings.arm import draw_branch, draw_links, draw_pedestal
from app.reports.drawings.contest_style import shown_targets
from app.reports.drawings.labels import plain_text
from solver import Array, Problem, link_transforms
from solver.comparison.result import Comparison

MOST_POSTURES: Final = 6
COLUMNS: Final = 3
BORDER_M: Final = 0.03


def draw_contest_poses(comparison: Comparison, problem: Problem) -> Figure:
    """A panel a method with its postures at MOST_POSTURES targets at most, all to one scale."""
    targets = shown_targets(comparison, problem.targets, MOST_POSTURES)
    shown = {target.id for target in targets}
    methods = [summary.method for summary in comparison.summaries]
    columns = min(COLUMNS, len(methods))
    lines = math.ceil(len(methods) / columns)
    figure = Figure(figsize=(5.2 * columns, 5.4 * lines), facecolor="white")
    figure.subplots_adjust(left=0, right=0.97, bottom=0.04, top=0.97, wspace=0, hspace=0)
    palette = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, len(targets)))
    colours = dict(zip((target.id for target in targets), palette, strict=True))
    low, high = _extent(comparison, problem, shown)
    for place, method in enumerate(methods):
        axes: Axes3D = figure.add_subplot(lines, columns, place + 1, projection="3d")
        draw_branch(axes, targets, joined=False)
        draw_pedestal(axes)
        missing = []
        for row in comparison.rows:
            if row.method != method or row.target_id not in shown:
                continue
            if row.joints is None or not row.solved:
                missing.append(plain_text(row.target_id))
                continue
            draw_links(axes, problem, row.joints, colours[row.target_id], row.target_id)
        _frame_box(axes, low - BORDER_M, high + BORDER_M)
        axes.view_init(elev=18, azim=-62)
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        axes.set_zlabel("z [m]")
        axes.tick_params(labelsize=7, pad=0)
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            axis.set_major_locator(MaxNLocator(5))
        title = plain_text(method)
        if missing:
            title += f"\nno answer: {', '.join(missing)}"
        axes.text2D(0.5, 0.97, title, fontsize=13, ha="center", va="top", transform=axes.transAxes)
    return figure


def _frame_box(axes: Axes3D, low: Array, high: Array) -> None:
    """Show a box, to scale [m]."""
    # A flat box would leave most of the panel empty and its own labels on top of each other.
    half = np.maximum(high - low, 0.75 * np.max(high - low)) / 2
    centre = (low + high) / 2
    for set_limits, middle, size in zip(
        (axes.set_xlim, axes.set_ylim, axes.set_zlim), centre, half, strict=True
    ):
        set_limits(middle - size, middle + size)
    axes.set_box_aspect(half, zoom=1.0)


def _extent(comparison: Comparison, problem: Problem, shown: set[str]) -> tuple[Array, Array]:
    """The corners of the box that holds every posture, target and the base [m]."""
    places = [
        np.zeros((1, 3)),
        np.array([target.position_m for target in problem.targets if target.id in shown]),
    ]
    for row in comparison.rows:
        if row.joints is not None and row.target_id in shown:
            frames = link_transforms(problem.robot, problem.mounted_tool, np.array(row.joints))
            places.append(frames[:, :3, 3])
    every = np.concatenate(places)
    return every.min(axis=0), every.max(axis=0)
