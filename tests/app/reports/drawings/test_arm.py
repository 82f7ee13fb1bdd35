from app.reports.drawings.arm import draw_arm
from tests.app.reports.drawings.plans import Planned


def test_arm_is_drawn_for_every_planned_target(mixed: Planned) -> None:
    figure = draw_arm(*mixed)
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["1", "2", "3", "4", "5"]


def test_a_plan_without_planned_targets_can_be_drawn(nothing_planned: Planned) -> None:
    assert draw_arm(*nothing_planned).axes
