"""Zones of the ladder: what each hands to the next, on stand-ins for what is costly."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.task.relaxation import Placement
from solver.approach.task.task import ApproachTask
from solver.methods.relaxed import search
from solver.methods.relaxed.points import Point
from solver.methods.relaxed.programme import ProgrammeEnd
from solver.methods.relaxed.search import (
    Offers,
    _best,
    _lies_in,
    _restored,
    _zone_offers,
    relaxed_offers,
)
from tests.solver.methods.synthetic import small_task

OUTWARD = small_task().frame.outward


def point(
    effort: float, strike: float = 0.0, tilt: float = 0.0, branch: int = 2, level: float = 0.0
) -> Point:
    place = Placement(0.1, strike, tilt * OUTWARD)
    return Point(place, 1, branch, effort, level, np.zeros((2, 6)))


def relaxed(strike_m: float = 0.02, tilt_rad: float = 0.2, **options: object) -> ApproachTask:
    return small_task(strike_zone_m=strike_m, tilt_tolerance_rad=tilt_rad, **options)


def end(effort: float) -> ProgrammeEnd:
    return ProgrammeEnd("solved", 7, effort, Placement(0.2, 0.011, 0.05 * OUTWARD))


def stand_in(
    monkeypatch: pytest.MonkeyPatch,
    below: Sequence[Point] = (),
    at_end: Sequence[Point] = (),
    ended: ProgrammeEnd | None = None,
) -> list[tuple[object, ...]]:
    """What was asked of the descent, the programme and the closed form."""
    asked: list[tuple[object, ...]] = []

    def descended(_: object, near: Placement, looks: int) -> list[Point]:
        asked.append(("descended", near, looks))
        return list(below)

    def programme(_: object, start: Point) -> ProgrammeEnd:
        asked.append(("programme", start))
        return ended or end(1.0)

    def optimum(_: object, strike: float, swing: np.ndarray) -> list[Point]:
        asked.append(("optimum", strike, swing.tolist()))
        return list(at_end)

    monkeypatch.setattr(search, "descended", descended)
    monkeypatch.setattr(search, "programme_from", programme)
    monkeypatch.setattr(search, "optimum_at", optimum)
    return asked


def test_without_relaxations_a_zone_offers_what_is_known() -> None:
    known = [point(3.0, branch=1), point(2.0, branch=0), point(4.0, branch=1)]
    assert _zone_offers(relaxed(0.0, 0.0), known) == Offers((known[1], known[0]))


def test_a_zone_descends_from_the_best_and_the_programme_goes_on_from_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = [point(5.0, 0.004, branch=1), point(4.0, 0.006, branch=2)]
    below, at_end = [point(3.0, 0.01)], [point(2.0, 0.011)]
    asked = stand_in(monkeypatch, below, at_end, end(2.0))
    offers = _zone_offers(relaxed(), known)
    assert asked == [
        ("descended", known[1].placement, 80),
        ("programme", below[0]),
        ("optimum", 0.011, (0.05 * OUTWARD).tolist()),
    ]
    assert offers == Offers((at_end[0], known[0]), 7, "solved")


def test_a_descent_that_finds_nothing_better_is_not_started_from(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = [point(4.0, 0.006)]
    asked = stand_in(monkeypatch, [point(4.5)], [point(4.2)], end(4.0))
    offers = _zone_offers(relaxed(), known)
    assert asked[1] == ("programme", known[0])
    assert offers.points == (known[0],)


@pytest.mark.parametrize(("share", "goes_on"), [(0.5e-6, False), (2e-6, True)])
def test_where_the_closed_form_is_dearer_than_the_programme_the_descent_goes_on(
    monkeypatch: pytest.MonkeyPatch, share: float, goes_on: bool
) -> None:
    known, at_end = [point(4.0, 0.006)], [point(3.0, 0.011)]
    asked = stand_in(monkeypatch, [], at_end, end(3.0 / (1 + share)))
    _zone_offers(relaxed(), known)
    assert asked[3:] == ([("descended", at_end[0].placement, 240)] if goes_on else [])


def test_what_bears_more_is_better_though_dearer(monkeypatch: pytest.MonkeyPatch) -> None:
    bears = point(6.0, 0.01, level=0.001)
    asked = stand_in(monkeypatch, [bears], [point(2.0)], end(6.0))
    assert _zone_offers(relaxed(), [point(4.0)]).points == (bears,)
    assert asked[1] == ("programme", bears)
    assert len(asked) == 3


def test_where_nothing_is_known_the_zone_is_searched_for_something_that_holds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = [point(9.0, 0.01)]
    stand_in(monkeypatch)
    monkeypatch.setattr(search, "_restored", lambda _: found)
    assert _zone_offers(relaxed(), []).points == tuple(found)
    monkeypatch.setattr(search, "_restored", lambda _: [])
    assert _zone_offers(relaxed(), []) == Offers(())


def test_of_points_the_best_of_each_branch_and_four_at_most() -> None:
    points = [point(10.0 - k, branch=k % 6) for k in range(9)]
    kept = _best(points)
    assert [one.effort for one in kept] == [2.0, 3.0, 4.0, 5.0]
    assert [one.branch for one in kept] == [2, 1, 0, 5]
    other_side = replace(point(2.5), tool_side=-1)
    assert _best([*points, other_side])[:2] == (points[8], other_side)


@pytest.mark.parametrize(
    ("strike", "tilt", "inside"),
    [
        (0.02, 0.2, True),
        (0.0200001, 0.1, False),
        (0.01, 0.2 + 1e-13, True),
        (0.01, 0.2 + 1e-10, False),
        (0.0, 0.0, True),
    ],
)
def test_a_point_lies_in_a_zone_that_reaches_to_it(
    strike: float, tilt: float, inside: bool
) -> None:
    assert _lies_in(relaxed(), point(1.0, strike, tilt)) == inside


def zone_key(task: ApproachTask) -> tuple[float, float]:
    return round(task.options.strike_zone_m, 6), round(
        math.degrees(task.options.tilt_tolerance_rad), 6
    )


def test_every_zone_is_given_what_its_smaller_neighbours_offer_and_what_lies_in_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked = [
        point(8.0),
        point(7.0, 0.03),
        point(6.0, 0.0, math.radians(15)),
        point(5.0, 0.035, 0.3),
    ]
    given: dict[tuple[float, float], list[Point]] = {}
    made: dict[tuple[float, float], Point] = {}

    def zone_offers(zone: ApproachTask, known: Sequence[Point]) -> Offers:
        key = zone_key(zone)
        given[key] = list(known)
        made[key] = point(1.0 + len(made), branch=len(made) % 8)
        return Offers((made[key],), 2 ** (len(made) - 1), f"zone {key}")

    monkeypatch.setattr(search, "optima_at", lambda *_: looked)
    monkeypatch.setattr(search, "_zone_offers", zone_offers)
    offers = relaxed_offers(relaxed(0.04, math.radians(20)))
    strikes, tilts = (0.0, 0.02, 0.04), (0.0, 10.0, 20.0)
    assert list(given) == [(strike, tilt) for strike in strikes for tilt in tilts]
    for i, strike in enumerate(strikes):
        for j, tilt in enumerate(tilts):
            expected = [made[strikes[i - 1], tilt]] if i else []
            expected += [made[strike, tilts[j - 1]]] if j else []
            inside = [
                one
                for one in looked
                if one.placement.strike_m <= strike
                and one.placement.tilt_rad <= math.radians(tilt) + 1e-9
            ]
            assert given[strike, tilt] == [*expected, *inside]
    assert offers == Offers((made[0.04, 20.0],), 2**9 - 1, "zone (0.04, 20.0)")


def test_nothing_looked_at_and_nothing_restored_offers_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(search, "optima_at", lambda *_: [])
    monkeypatch.setattr(search, "_restored", lambda _: [])
    monkeypatch.setattr(search, "_zone_offers", None)
    assert relaxed_offers(relaxed()) == Offers(())


def test_restored_points_of_both_tool_sides_are_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    task = relaxed(symmetric_tool=True)
    sides = []

    def restored(kernels: object, zone: np.ndarray) -> np.ndarray:
        assert zone.tolist() == [0.02, 0.2]
        sides.append(next(s for s in (1, -1) if task.for_kernels(s) is kernels))
        return np.array([[0.01, 0.1, -0.05], [0.02, 0.0, 0.2]]) * sides[-1]

    monkeypatch.setattr(search, "restored_points", restored)
    monkeypatch.setattr(search, "optima_at", lambda _, strikes, swings: (strikes, swings))
    found: Any = _restored(task)
    strikes, swings = found
    assert sides == [1, -1]
    assert strikes.tolist() == [0.01, 0.02, -0.01, -0.02]
    u, v = task.frame.outward, task.frame.sideways
    expected = [0.1 * u - 0.05 * v, 0.2 * v, -0.1 * u + 0.05 * v, -0.2 * v]
    np.testing.assert_allclose(swings, expected, atol=1e-15)
