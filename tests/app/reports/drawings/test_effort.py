import numpy as np
import pytest

from app.reports.drawings.effort import CHOSEN_COLOUR, draw_effort
from tests.app.reports.drawings.plans import Planned


def test_effort_panels_mark_the_chosen_approach(mixed: Planned) -> None:
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


def test_a_plan_without_planned_targets_can_be_drawn(nothing_planned: Planned) -> None:
    (panel,) = draw_effort(*nothing_planned).axes
    assert not panel.lines
