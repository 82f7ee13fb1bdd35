"""Pictures of plans, drawn from the JSON answer."""

import io
from typing import Any

import numpy as np
import orjson
import pytest
from rich.console import Console

from app.commands.plan_table import print_plan
from app.reports.drawings.arm import draw_arm
from app.reports.drawings.effort import CHOSEN_COLOUR, draw_effort
from app.schemas.demo_request import demo_request
from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import Problem, solve


def planned(request: dict[str, Any]) -> tuple[dict[str, Any], Problem]:
    problem = problem_from_wire(parse_request(orjson.dumps(request)))
    return plan_to_wire(solve(problem), "0" * 32), problem


@pytest.fixture(scope="module")
def mixed() -> tuple[dict[str, Any], Problem]:
    """Data set 3 with a target out of reach among the others."""
    request = demo_request()
    far = {"id": "far", "position_m": [0.0, 2.0, 0.1], "branch_direction": [0, 0, 1]}
    request["targets"].insert(1, far)
    return planned(request)


def test_effort_panels_mark_the_chosen_approach(mixed: tuple[dict[str, Any], Problem]) -> None:
    plan, problem = mixed
    figure = draw_effort(plan, problem)
    chosen = [a for a in plan["approaches"] if a["status"] == "planned"]
    assert len(figure.axes) == len(chosen) == 5
    for axes, approach in zip(figure.axes, chosen, strict=True):
        (mark,) = [line for line in axes.lines if line.get_color() == CHOSEN_COLOUR]
        angle, effort = (float(np.asarray(data)[0]) for data in mark.get_data())
        assert angle == pytest.approx(np.degrees(approach["approach_angle_rad"]))
        assert effort == approach["effort"]
        # The choice lies on the curve of its branch, though not at its lowest: that of a batch
        # also looks at what it costs the next target.
        (curve,) = [
            np.asarray(line.get_data())
            for line in axes.lines
            if line.get_label() == f"branch {approach['branch']}" and np.size(line.get_xdata()) > 2
        ]
        known = np.isfinite(curve[1])
        near = np.interp(angle, curve[0, known], curve[1, known])
        assert near == pytest.approx(effort, abs=0.01)


def test_arm_is_drawn_for_every_planned_target(mixed: tuple[dict[str, Any], Problem]) -> None:
    figure = draw_arm(*mixed)
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["1", "2", "3", "4", "5"]


def test_a_plan_without_planned_targets_can_be_drawn_and_printed() -> None:
    request = demo_request()
    request["targets"] = [
        {"id": "far", "position_m": [0.0, 2.0, 0.1], "branch_direction": [0, 0, 1]}
    ]
    plan, problem = planned(request)
    draw_arm(plan, problem)
    draw_effort(plan, problem)
    console = Console(record=True, width=200, file=io.StringIO())
    print_plan(plan, console)
    assert "far: out_of_reach" in console.export_text()
