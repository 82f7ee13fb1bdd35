"""How weights are drawn."""

import pytest
from matplotlib.patches import Rectangle

from app.reports.drawings.weights import draw_weights, robots_with_masses
from solver.kinematics.torque_weights import torque_weights


def test_weights_are_drawn_as_they_are() -> None:
    robots = robots_with_masses()
    assert {"puma560", "puma560_rail", "tabletop"} <= {robot.name for robot in robots}
    figure = draw_weights(robots)
    figure.canvas.draw()
    for robot, axes in zip(robots, figure.axes[1::2], strict=True):
        tool = robot.tool(robot.default_tool)
        assert tool is not None
        heights = [bar.get_height() for bar in axes.patches if isinstance(bar, Rectangle)]
        assert heights == pytest.approx(torque_weights(robot, tool))
        assert robot.mass_source in axes.get_title()
        assert [label.get_text() for label in axes.get_xticklabels()] == list(robot.joint_names)
