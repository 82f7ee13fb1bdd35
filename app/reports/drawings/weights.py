"""The torque weights of every robot with masses, and the torques that they are from.

Run as `python -m app.reports.drawings.weights PICTURE.png`.
"""

import sys
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from solver import Robot, load_robot, robot_names, torque_parts, torque_weights

GRAVITY_COLOUR, INERTIA_COLOUR, WEIGHT_COLOUR = "#6b4a2b", "#e0457b", "#2e9e5b"


def draw_weights(robots: Sequence[Robot]) -> Figure:
    """One row a robot: its torques on the left, its weights beside `uniform` on the right."""
    figure = Figure(figsize=(11, 2.9 * len(robots) + 0.6), facecolor="white", layout="constrained")
    panels = figure.subplots(len(robots), 2, squeeze=False)
    for robot, (loads, weights) in zip(robots, panels, strict=True):
        tool = robot.tool(robot.default_tool)
        assert tool is not None, "parse_robot checks it"
        places = np.arange(len(robot.joints))
        gravity, inertia = torque_parts(robot, tool)
        loads.bar(places - 0.2, gravity, 0.4, color=GRAVITY_COLOUR, label="gravity")
        loads.bar(places + 0.2, inertia, 0.4, color=INERTIA_COLOUR, label="inertia")
        loads.set_yscale("symlog", linthresh=0.01)
        loads.set_ylabel("RMS torque [N m], slide [N]")
        loads.set_title(f"{robot.name} with {tool.name}")
        loads.legend(frameon=False)
        bars = weights.bar(places, torque_weights(robot, tool), 0.6, color=WEIGHT_COLOUR)
        weights.bar_label(bars, fmt="%.2f", fontsize=8)
        weights.axhline(1.0, color="grey", linewidth=0.9, linestyle="--", label="uniform")
        weights.set_ylabel("weight")
        weights.margins(y=0.15)
        weights.set_title(f"masses: {robot.mass_source}", fontsize=8)
        weights.legend(frameon=False)
        for axes in (loads, weights):
            axes.set_xticks(places, robot.joint_names, rotation=20)
    return figure


def robots_with_masses() -> list[Robot]:
    """The robots that have torque weights."""
    return [robot for robot in map(load_robot, robot_names()) if robot.has_masses]


if __name__ == "__main__":
    draw_weights(robots_with_masses()).savefig(sys.argv[1], dpi=90)
