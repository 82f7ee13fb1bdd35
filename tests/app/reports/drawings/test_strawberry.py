"""The poses of the strawberry mechanism, compared with what was drawn."""

import io
from pathlib import Path

import numpy as np
import pytest

from app.reports.drawings.strawberry import SHOWN, draw_poses, main
from solver.comparison.scenarios.strawberry import METHODS
from solver.comparison.strawberry.mechanism import forward_kinematics
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered

TARGET = TARGETS[0]


def test_every_method_is_drawn_with_its_index_and_ends_at_the_target() -> None:
    answers = {name: answered(METHODS[name](MECHANISM, TARGET)) for name in SHOWN}
    figure = draw_poses(TARGET, {name: answer.posture for name, answer in answers.items()})
    whole, close = figure.axes[::2], figure.axes[1::2]
    assert len(whole) == len(close) == len(SHOWN) == 3
    for axes, near, (name, answer) in zip(whole, close, answers.items(), strict=True):
        assert axes.get_title() == f"{name}: J = {answer.index_j * 1000:.1f} N mm"
        for panel in (axes, near):
            (last,) = [line for line in panel.lines if line.get_label() == "$l_3$"]
            drawn = np.array(last.get_data_3d())[:, -1]  # type: ignore[attr-defined]
            assert drawn == pytest.approx(TARGET, abs=1e-9)
    figure.savefig(io.BytesIO())


def test_a_posture_that_misses_is_drawn_where_it_is() -> None:
    missed = answered(METHODS["as_printed_18"](MECHANISM, TARGET)).posture
    axes = draw_poses(TARGET, {"as_printed_18": missed}).axes[0]
    (last,) = [line for line in axes.lines if line.get_label() == "$l_3$"]
    drawn = np.array(last.get_data_3d())[:, -1]  # type: ignore[attr-defined]
    assert drawn == pytest.approx(forward_kinematics(MECHANISM, missed), abs=1e-9)
    assert np.linalg.norm(drawn - TARGET) > 0.04


def test_the_command_writes_the_picture_of_any_target(tmp_path: Path) -> None:
    main([str(tmp_path / "poses.png"), "20"])
    assert (tmp_path / "poses.png").read_bytes().startswith(b"\x89PNG")
