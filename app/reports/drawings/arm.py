"""The arm in its thinning postures, with the branch, the approach circles and the cut-ins."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]

from app.reports.drawings.labels import plain_text
from app.reports.drawings.references import planned_with_references
from solver import (
    ApproachFrame,
    Arc,
    Array,
    Problem,
    Target,
    approach_frame,
    link_transforms,
    survey_target,
)

BRANCH_COLOUR, BLOSSOM_COLOUR, FREE_COLOUR, BLOCKED_COLOUR = (
    "#6b4a2b",
    "#e0457b",
    "#2e9e5b",
    "#c9c9c9",
)
FORK_HALF_GAP_M = 0.012
FORK_LENGTH_M = 0.035


def draw_arm(plan: Mapping[str, Any], problem: Problem) -> Figure:
    """The whole arm on the left, the branch close up on the right."""
    figure = Figure(figsize=(15, 7.6), facecolor="white")
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.03, top=0.9, wspace=0.0)
    whole: Axes3D = figure.add_subplot(1, 2, 1, projection="3d")
    close: Axes3D = figure.add_subplot(1, 2, 2, projection="3d")
    steps = list(planned_with_references(plan, problem))
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, max(len(steps), 1)))
    places = np.array([target.position_m for target in problem.targets])
    for axes in (whole, close):
        draw_branch(axes, problem.targets)
        for (approach, target, reference), colour in zip(steps, colours, strict=False):
            arcs = survey_target(problem, target, reference).arcs
            draw_circle(axes, target, problem.options.standoff_m, arcs)
            _draw_cut_in(axes, problem, approach, colour)
            draw_links(axes, problem, approach["thinning_joints"], colour, approach["target_id"])
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        axes.set_zlabel("z [m]")
    draw_pedestal(whole)
    reach = float(np.abs(places).max()) + 0.05
    frame_cube(whole, np.array([reach / 2 - 0.1, 0.0, reach / 2]), reach / 2)
    frame_cube(close, places.mean(axis=0) - (0.0, 0.0, 0.015), 0.075)
    whole.view_init(elev=18, azim=-62)
    close.view_init(elev=14, azim=-35)
    whole.set_title(f"{len(steps)} thinning postures of {plan['robot']}", fontsize=13)
    close.set_title("approach circles: feasible arcs green; cut-ins arrive at the blossoms")
    method = plan["options"]["method"]
    figure.suptitle(f"Approaches planned by {method} and verified", fontsize=15)
    if steps:
        whole.legend(loc="upper left", frameon=False, title="target")
    return figure


def draw_branch(axes: Axes3D, targets: Sequence[Target], *, joined: bool = True) -> None:
    """The blossoms with their ids, a piece of each one's branch, and a line if it is one branch."""
    for target in targets:
        along = approach_frame(target.position_m, target.branch_direction).branch
        ends = np.array(target.position_m) + np.outer((-0.022, 0.022), along)
        axes.plot(*ends.T, color=BRANCH_COLOUR, linewidth=5, solid_capstyle="round", zorder=1)
    places = np.array([target.position_m for target in targets])
    if joined:
        axes.plot(*places.T, color=BRANCH_COLOUR, linewidth=1, linestyle=":", zorder=1)
    axes.scatter(*places.T, s=90, color=BLOSSOM_COLOUR, edgecolor="white", depthshade=False)
    for target, place in zip(targets, places, strict=True):
        axes.text(
            *(place + np.array((0.0, 0.0, 0.008))), plain_text(target.id), fontsize=10, ha="center"
        )


def draw_circle(axes: Axes3D, target: Target, radius_m: float, arcs: tuple[Arc, ...]) -> None:
    """Where the standby of a target may be, feasible arcs in green."""
    frame = approach_frame(target.position_m, target.branch_direction)
    turn = np.linspace(-np.pi, np.pi, 121)
    axes.plot(*_standbys(target, frame, radius_m, turn).T, color=BLOCKED_COLOUR, linewidth=0.9)
    for arc in arcs:
        angles = np.linspace(arc.lower_rad, arc.upper_rad, 60)
        points = _standbys(target, frame, radius_m, angles)
        axes.plot(*points.T, color=FREE_COLOUR, linewidth=2.2, alpha=0.8)


def _standbys(target: Target, frame: ApproachFrame, radius_m: float, angles: Array) -> Array:
    directions = np.array([frame.direction(float(angle)) for angle in angles])
    return np.asarray(np.asarray(target.position_m) - radius_m * directions)


def _draw_cut_in(
    axes: Axes3D, problem: Problem, approach: Mapping[str, Any], colour: Array
) -> None:
    ends = np.array([approach["standby_joints"], approach["thinning_joints"]])
    places = link_transforms(problem.robot, problem.mounted_tool, ends)[:, -1, :3, 3]
    axes.plot(*places.T, color=colour, linewidth=3.5, solid_capstyle="round")
    axes.scatter(*places[0], s=28, color=[colour], depthshade=False)


def draw_links(
    axes: Axes3D, problem: Problem, joints: Sequence[float], colour: Any, label: str
) -> None:
    """The arm in one posture [rad or m], with its forks."""
    frames = link_transforms(problem.robot, problem.mounted_tool, np.array(joints))
    # A link goes along its joint's axis first, then sideways by a.
    lengths = np.array([joint.a_m for joint in problem.robot.joints])
    bends = frames[1:, :3, 3] - lengths[:, None] * frames[1:, :3, 0]
    # The tool's frame is rolled against the last link, which has nothing to go sideways for.
    bends[-1] = frames[-2, :3, 3]
    corners = np.stack((bends, frames[1:, :3, 3]), axis=1).reshape(-1, 3)
    corners = np.vstack((frames[0, :3, 3], corners))
    tool = frames[-1]
    palm = corners[-1] - FORK_LENGTH_M * tool[:3, 2]
    body = np.vstack((corners[:-1], palm))
    axes.plot(
        *body.T,
        color=colour,
        linewidth=4,
        alpha=0.75,
        solid_capstyle="round",
        label=plain_text(label),
    )
    axes.scatter(*corners[2:-1].T, s=34, color=[colour], edgecolor="white", depthshade=False)
    for side in (-1, 1):
        root = palm + side * FORK_HALF_GAP_M * tool[:3, 0]
        fork = np.array([palm, root, root + (FORK_LENGTH_M + 0.006) * tool[:3, 2]])
        axes.plot(*fork.T, color=colour, linewidth=2, alpha=0.9)


def draw_pedestal(axes: Axes3D) -> None:
    """What the arm stands on."""
    angles = np.linspace(0, 2 * np.pi, 40)
    for height in (0.0, 0.02):
        axes.plot(
            0.05 * np.cos(angles), 0.05 * np.sin(angles), height, color="#555555", linewidth=2
        )


def frame_cube(axes: Axes3D, centre: Array, half: float) -> None:
    """Show a cube about a centre [m]."""
    axes.set_xlim(centre[0] - half, centre[0] + half)
    axes.set_ylim(centre[1] - half, centre[1] + half)
    axes.set_zlim(centre[2] - half, centre[2] + half)
    axes.set_box_aspect((1, 1, 1), zoom=1.12)
