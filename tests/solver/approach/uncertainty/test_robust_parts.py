"""Parts of arcs that bear what is asked, of excesses that are told; and cut-ins as they are."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver.approach.task.packed import unpack_geometry
from solver.approach.uncertainty import robust_parts as module
from solver.approach.uncertainty.displacement import displacement_margin
from solver.approach.uncertainty.robust_parts import (
    MOST_PARTS,
    excess,
    extreme_excess,
    margin_at,
    margin_of_approach,
    most_borne,
    parts_of_arcs,
    robust_end,
    robust_parts,
    robust_work,
    write_cut_in,
)
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import wrist_geometry
from tests.solver.interpreted import interpret, interpreted
from tests.solver.methods.synthetic import small_task

Excess = Callable[[float], float]
SMALL = small_task(2)
TASK = SMALL.packed(1)
ROWS = len(TASK.retreats)
ANGLE, BRANCH = 0.2, 2
GEOMETRY = wrist_geometry(SMALL.robot, SMALL.tool)


def test_a_cut_in_is_written_with_its_pose() -> None:
    work = robust_work(ROWS)
    write_cut_in(TASK, GEOMETRY, ANGLE, BRANCH, work)
    expected = SMALL.postures(ANGLE, 1, BRANCH, TASK.retreats)
    assert work.rows == pytest.approx(expected, abs=1e-9)
    pose = forward_kinematics(SMALL.robot, SMALL.tool, expected[-1])
    assert work.pose[:3] == pytest.approx(np.linalg.inv(SMALL.robot.mount)[:3] @ pose, abs=1e-9)
    assert unpack_geometry(TASK.numbers) == GEOMETRY


@pytest.mark.parametrize("angle", [0.0, 0.2, 0.4])
def test_margins_are_those_of_the_cut_in_and_excesses_what_is_beyond(angle: float) -> None:
    """Exact near zero; further away only the sign is."""
    work = robust_work(ROWS)
    margin = margin_at(TASK, GEOMETRY, angle, BRANCH, work)
    known, _, _ = displacement_margin(SMALL.for_kernels(1), angle, BRANCH, np.empty((ROWS, 6)))
    assert margin == pytest.approx(known, rel=1e-9)
    assert margin > 0.001
    assert margin_of_approach(TASK, angle, BRANCH) == margin
    for needed in (0.9 * margin, margin * 1.1, margin):
        beyond = excess(TASK, GEOMETRY, angle, BRANCH, needed, work)
        assert beyond == pytest.approx(margin - needed, abs=1e-12)
    for needed in (0.01 * margin, 30 * margin):
        beyond = excess(TASK, GEOMETRY, angle, BRANCH, needed, work)
        assert (beyond > 0.0) == (needed < margin)


class Told:
    """Excesses over what is needed, by angle."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, curve: Excess) -> None:
        self.asked: list[float] = []

        def stand_in(task: object, g: object, angle: float, branch: int, needed: float,
                     work: object) -> float:  # fmt: skip
            assert (branch, needed) == (BRANCH, 0.003)
            self.asked.append(float(angle))
            return curve(float(angle))

        def margin(task: object, g: object, angle: float, branch: int, work: object) -> float:
            assert branch == BRANCH
            self.asked.append(float(angle))
            return curve(float(angle))

        interpret(monkeypatch, module, excess=stand_in, margin_at=margin)

    def parts(self, low: float, high: float) -> list[list[float]]:
        work = robust_work(ROWS)
        count = interpreted(robust_parts)(TASK, GEOMETRY, BRANCH, low, high, 0.003, work)
        return work.parts[:count].tolist()  # type: ignore[no-any-return]


def test_all_of_an_arc_or_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, lambda x: 0.001)
    assert told.parts(0.1, 0.5) == [[0.1, 0.5]]
    assert told.asked[:17] == pytest.approx(np.linspace(0.1, 0.5, 17))
    assert Told(monkeypatch, lambda x: -0.001).parts(0.1, 0.5) == []
    assert Told(monkeypatch, lambda x: 0.0).parts(0.1, 0.5) == [[0.1, 0.5]]
    short = Told(monkeypatch, lambda x: 0.001)
    short.parts(0.1, 0.11)
    assert sorted(set(short.asked)) == pytest.approx(np.linspace(0.1, 0.11, 5))


@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_parts_end_where_the_excess_does_from_inside(
    monkeypatch: pytest.MonkeyPatch, scale: float
) -> None:
    def waves(x: float) -> float:
        return scale * math.sin(9 * x)

    told = Told(monkeypatch, waves)
    parts = told.parts(-1.0, 1.0)
    thirds = math.pi / 9
    ends = [[-2 * thirds, -thirds], [0.0, thirds], [2 * thirds, 1.0]]
    assert len(parts) == 3
    for part, wanted in zip(parts, ends, strict=True):
        for angle, end in zip(part, wanted, strict=True):
            assert waves(angle) >= 0.0
            assert angle == pytest.approx(end, abs=2e-6 if scale < 1.0 else 2e-9)


@pytest.mark.parametrize("at", [0.2, 0.3001, 0.512])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_narrow_peaks_and_gaps_between_samples_are_found(
    monkeypatch: pytest.MonkeyPatch, at: float, sign: float
) -> None:
    """Where slopes beside them tell of one."""

    def tent(x: float) -> float:
        return sign * (0.004 - abs(x - at))

    parts = Told(monkeypatch, tent).parts(0.1, 0.7)
    if sign > 0:
        assert np.array(parts) == pytest.approx(np.array([[at - 0.004, at + 0.004]]), abs=1e-7)
    else:
        wanted = np.array([[0.1, at - 0.004], [at + 0.004, 0.7]])
        assert np.array(parts) == pytest.approx(wanted, abs=1e-7)


def test_no_extreme_is_looked_for_where_slopes_do_not_reach_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch, lambda x: -1.0 - (x - 0.4) ** 2)
    assert told.parts(0.1, 0.7) == []
    assert len(told.asked) == 25


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_extreme_of_an_excess(monkeypatch: pytest.MonkeyPatch, sign: float) -> None:
    told = Told(monkeypatch, lambda x: -sign * (0.1 + abs(x - 0.37)))
    where, value = interpreted(extreme_excess)(TASK, GEOMETRY, BRANCH, 0.35, 0.4, sign, 0.003, None)
    assert where == pytest.approx(0.37, abs=1e-4)
    assert value == pytest.approx(-sign * 0.1, abs=1e-4)
    assert len(told.asked) == 16
    told = Told(monkeypatch, lambda x: sign * (0.01 - abs(x - 0.37)))
    where, value = interpreted(extreme_excess)(TASK, GEOMETRY, BRANCH, 0.3, 0.4, sign, 0.003, None)
    assert sign * value > 0.0
    assert len(told.asked) <= 5


CURVES: dict[str, Excess] = {
    "line": lambda x: 0.02 * (0.3 - x),
    "bent": lambda x: 0.02 * (0.3 - x) + 0.5 * (0.3 - x) ** 3,
    "steep then flat": lambda x: 1e-3 * (math.exp(60 * (0.3 - x)) - 1.0),
    "flat then steep": lambda x: -1e-3 * (math.exp(60 * (x - 0.3)) - 1.0),
    "step": lambda x: 0.01 if x < 0.3 else -0.01,
}


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("flip", [1.0, -1.0])
def test_an_end_is_robust_and_next_to_what_is_not(
    monkeypatch: pytest.MonkeyPatch, name: str, flip: float
) -> None:
    """Within a hundredth of a micrometre of excess, or 1e-9 rad."""

    def curve(x: float) -> float:
        return CURVES[name](flip * x)

    told = Told(monkeypatch, curve)
    inside, outside = flip * 0.2, flip * 0.35
    found = interpreted(robust_end)(
        TASK, GEOMETRY, BRANCH, inside, curve(inside), outside, curve(outside), 0.003, None
    )
    assert curve(found) >= 0.0
    assert curve(found) <= 1e-8 or abs(flip * found - 0.3) <= 1e-9
    assert len(told.asked) <= (12 if name in ("line", "bent") else 45)
    assert all(0.2 <= flip * angle <= 0.35 for angle in told.asked)


def test_an_end_that_is_near_enough_is_not_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, lambda x: 0.3 - x)
    for given in ((0.2, 1e-8, 0.4, -0.1), (0.2, 0.1, 0.2 + 1e-9, -0.1)):
        assert interpreted(robust_end)(TASK, GEOMETRY, BRANCH, *given, 0.003, None) == 0.2
    assert told.asked == []


def test_parts_of_several_arcs_are_listed_with_their_place(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers, seen = np.stack((TASK.numbers, TASK.numbers + 1.0)), []

    def stand_in(task: Any, g: Any, branch: int, low: float, high: float, needed: float,
                 work: Any) -> int:  # fmt: skip
        seen.append((float(task.numbers[0] - TASK.numbers[0]), int(branch), needed))
        work.parts[:40, 0] = low + np.arange(40)
        work.parts[:40, 1] = high + np.arange(40)
        return 0 if branch == 5 else 40

    interpret(monkeypatch, module, robust_parts=stand_in)
    table = interpreted(parts_of_arcs)(
        0.003, numbers, TASK.retreats, TASK.cos_steps, np.array([0, 1, 1, 0, 1]),
        np.array([4, 5, 6, 7, 3]), np.zeros(5), np.ones(5),
    )  # fmt: skip
    assert seen == [
        (0.0, 4, 0.003),
        (1.0, 5, 0.003),
        (1.0, 6, 0.003),
        (0.0, 7, 0.003),
        (1.0, 3, 0.003),
    ]
    assert table[:, 0].tolist() == np.repeat([0, 2, 3, 4], 40).tolist()
    assert table[:, 1].tolist() == np.tile(np.arange(40), 4).tolist()
    assert table[:, 2].tolist() == np.tile(np.arange(1, 41), 4).tolist()
    assert MOST_PARTS >= 40


@pytest.mark.parametrize("at", [0.1, 0.333, 0.5])
def test_where_most_is_borne(monkeypatch: pytest.MonkeyPatch, at: float) -> None:
    told = Told(monkeypatch, lambda x: 0.01 - (x - at) ** 2)
    found = interpreted(most_borne)(TASK, BRANCH, 0.1, 0.5)
    assert found == pytest.approx(at, abs=1e-6)
    assert told.asked[:17] == pytest.approx(np.linspace(0.1, 0.5, 17))
    assert len(told.asked) < 130


def test_an_arc_of_the_arm_s_bears_what_it_says() -> None:
    """The parts' own margins, against what is needed, inside and beyond."""
    needed = 0.006
    parts = parts_of_arcs(
        needed, TASK.numbers[None], TASK.retreats, TASK.cos_steps,
        np.array([0]), np.array([BRANCH]), np.array([-0.3]), np.array([0.4]),
    )  # fmt: skip
    assert len(parts) >= 1
    for _, low, high in parts:
        inside = [margin_of_approach(TASK, x, BRANCH) for x in np.linspace(low, high, 4)]
        assert min(inside) >= needed - 1e-7
        for end, step in ((low, -1e-4), (high, 1e-4)):
            if end not in (-0.3, 0.4):
                assert margin_of_approach(TASK, end + step, BRANCH) < needed
