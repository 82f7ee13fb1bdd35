"""The pictures of a comparison, drawn from its rows."""

import dataclasses

import numpy as np
import pytest

from app.reports.drawings.contest_effort import can_draw_effort, draw_contest_effort
from app.reports.drawings.contest_poses import draw_contest_poses
from app.reports.drawings.contest_strawberry import draw_strawberry
from app.reports.drawings.contest_style import shown_targets
from app.reports.drawings.contest_times import draw_times
from app.reports.drawings.labels import LONGEST_LABEL, plain_text
from app.reports.picture import EFFORT, POSES, TIMES
from app.reports.pictures import draw_pictures
from solver import Options, Problem, Target, load_robot
from solver.comparison.contest import Contest, with_entrants
from solver.comparison.registry import SCENARIOS
from solver.comparison.result import Comparison
from solver.comparison.run import run_contest
from solver.comparison.scenarios.own_request import request_contest
from tests.solver.comparison.contests import small_contest

HOSTILE = (r"$\frac{$ <b>", "桃の花 " * 20, "\n\t")
PLACES = ((0.185, -0.057, 0.42), (0.18, -0.04, 0.43), (2.0, 0.0, 0.3))


@pytest.fixture(scope="module")
def contest() -> Contest:
    targets = [
        Target(name, place, (-1, -1, 1)) for name, place in zip(HOSTILE, PLACES, strict=True)
    ]
    return request_contest(Problem(load_robot("tabletop"), targets), "mine", ("as", "ssas"))


@pytest.fixture(scope="module")
def comparison(contest: Contest) -> Comparison:
    return run_contest(contest, repeats=1)


def test_choices_lie_on_their_curves(contest: Contest, comparison: Comparison) -> None:
    assert contest.problem is not None
    figure = draw_contest_effort(comparison, contest.problem)
    assert len(figure.axes) == len(HOSTILE)
    for axes, target_id in zip(figure.axes, HOSTILE, strict=True):
        rows = [row for row in comparison.rows if row.target_id == target_id and row.solved]
        marks = [line for line in axes.lines if line.get_markersize() == 10]
        assert len(marks) == len(rows) == (0 if target_id == HOSTILE[2] else 2)
        for mark, row in zip(marks, rows, strict=True):
            (angle,), (effort,) = (np.atleast_1d(np.asarray(data)) for data in mark.get_data())
            assert effort == row.index
            heights = [
                np.interp(angle, *np.asarray(line.get_data(), dtype=float)[:, known])
                for line in axes.lines
                if np.size(line.get_xdata()) > 2
                and (known := np.isfinite(np.asarray(line.get_ydata(), dtype=float))).any()
            ]
            assert min(abs(height - effort) for height in heights) < 0.01


def test_every_method_has_its_panel_and_failures_are_named(
    contest: Contest, comparison: Comparison
) -> None:
    assert contest.problem is not None
    figure = draw_contest_poses(comparison, contest.problem)
    titles = [[text.get_text() for text in axes.texts][-1] for axes in figure.axes]
    assert [title.split("\n")[0] for title in titles] == ["as", "ssas"]
    assert all("no answer: " in title for title in titles)
    for axes in figure.axes:
        arms = [line for line in axes.lines if line.get_label() == plain_text(HOSTILE[0])]
        assert len(arms) == 1


def test_all_answers_and_all_failures_are_points_in_the_picture_of_times() -> None:
    comparison = run_contest(small_contest(), repeats=1)
    figure = draw_times(comparison)
    for axes in figure.axes:
        points = sum(len(np.asarray(marks.get_offsets())) for marks in axes.collections)
        assert points == len(comparison.rows)
        left, right = axes.get_xlim()
        assert all(left < 1000 * row.time_s < right for row in comparison.rows)
    (legend,) = figure.legends
    labels = {text.get_text() for text in legend.get_texts()}
    assert labels == {
        "ncos", "as", "half", "wrong, no answer (3)", "raises, no answer (3)",
        "half, no answer (1)",
    }  # fmt: skip


def test_reports_have_the_pictures_that_their_contest_allows(
    contest: Contest, comparison: Comparison
) -> None:
    pictures = draw_pictures(contest, comparison)
    assert [picture.file for picture in pictures] == [POSES, EFFORT, TIMES]
    assert all(picture.png.startswith(b"\x89PNG") for picture in pictures)
    bare = small_contest()
    assert [entry.file for entry in draw_pictures(bare, run_contest(bare, repeats=1))] == [TIMES]


def test_effort_is_drawn_only_where_it_counts_from_the_start() -> None:
    targets = [Target(str(k), place, (-1, -1, 1)) for k, place in enumerate(PLACES)]
    robot = load_robot("tabletop")
    assert can_draw_effort(Problem(robot, targets, options=Options(order="independent")))
    assert not can_draw_effort(Problem(robot, targets, options=Options(order="given")))
    rail = load_robot("puma560_rail")
    assert not can_draw_effort(Problem(rail, targets, options=Options(order="independent")))


def test_targets_that_somebody_reaches_come_into_the_picture(comparison: Comparison) -> None:
    targets = [Target(name, (0, 0, 0), (0, 0, 1)) for name in (HOSTILE[2], *HOSTILE[:2])]
    assert shown_targets(comparison, targets, 3) == tuple(targets)
    assert shown_targets(comparison, targets, 2) == tuple(targets[1:])
    failed = dataclasses.replace(
        comparison, rows=tuple(dataclasses.replace(row, solved=False) for row in comparison.rows)
    )
    assert shown_targets(failed, targets, 2) == tuple(targets[:2])


def test_strawberry_shows_the_papers_methods_that_were_run() -> None:
    contest = with_entrants(SCENARIOS["strawberry"].contest(None), ("as", "ssas", "as_printed"))
    comparison = run_contest(contest, repeats=1)
    titles = [axes.get_title() for axes in draw_strawberry(comparison).axes[::2]]
    first = {row.method: row.index for row in comparison.rows[:3]}
    assert titles == [f"{name}: J = {first[name]:.1f} N mm" for name in ("as", "ssas")]
    printed = run_contest(with_entrants(contest, ("as_printed",)), repeats=1)
    assert not draw_strawberry(printed).axes


@pytest.mark.parametrize("text", HOSTILE)
def test_labels_are_short_and_no_mathematics(text: str) -> None:
    label = plain_text(text)
    assert len(label.replace("\\$", "$")) <= LONGEST_LABEL
    assert label.isprintable()
    assert label.count("$") == label.count("\\$")
