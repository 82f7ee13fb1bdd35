"""`ncos` with relaxations: how offers are ranked, counted and told, on stand-ins for the search."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.candidate import Candidate
from solver.approach.task.relaxation import Placement
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.robustness import approach_margin
from solver.methods.candidates import at_angle
from solver.methods.coupling import Coupling
from solver.methods.relaxed import approach
from solver.methods.relaxed.approach import (
    _level,
    _on_its_arc,
    _point,
    between_neighbours,
    solve_relaxed,
)
from solver.methods.relaxed.points import Point, fixed_task, optima_at
from solver.methods.relaxed.programme import ProgrammeEnd
from solver.methods.relaxed.search import Offers
from solver.problem.solution import Reason
from tests.solver.methods.synthetic import small_task

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.2}
FOLLOWING = (0.4, 0.9, -1.0, 0.3, 1.2, -0.2)


def points_of(task: ApproachTask) -> list[Point]:
    swings = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [-0.1, 0.0], [0.0, -0.1], [0.05, 0.05]])
    frame = task.frame
    return optima_at(task, np.full(6, 0.005), swings @ (frame.outward, frame.sideways))


def kept_by(task: ApproachTask) -> Candidate:
    best = best_on_arcs(task)
    assert best is not None
    arc = best.arc
    joints = task.thinning_joints(best.angle_rad, arc.tool_side, arc.branch)
    return at_angle(task, best.angle_rad, arc.tool_side, arc.branch, joints)


@pytest.mark.parametrize(
    ("status", "told"), [("solved", "solved"), ("stalled", "warm_start_after_stalled")]
)
def test_the_first_point_is_the_answer_and_the_rest_wait(
    monkeypatch: pytest.MonkeyPatch, status: str, told: str
) -> None:
    task = small_task(1, **RELAXED)
    points = points_of(task)[:3]
    monkeypatch.setattr(approach, "relaxed_offers", lambda _: Offers(tuple(points), 23, status))
    answer = solve_relaxed(task)
    assert isinstance(answer, Candidate)
    assert (answer.iterations, answer.status) == (23, told)
    for one, point in zip((answer, *answer.others), points, strict=True):
        assert one.thinning_joints == tuple(point.postures[0])
        assert one.approach_angle_rad == pytest.approx(point.placement.approach_angle_rad)
        assert (one.tool_side, one.branch) == (point.tool_side, point.branch)
        assert one.effort == pytest.approx(point.effort)


def test_nothing_found_is_a_reason_that_names_the_relaxations(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(approach, "relaxed_offers", lambda _: Offers(()))
    monkeypatch.setattr(approach, "diagnose", lambda _: Reason("out_of_reach", "too far"))
    reason = solve_relaxed(small_task(1, **RELAXED))
    assert isinstance(reason, Reason)
    assert reason.code == "out_of_reach"
    assert reason.detail == "too far; none was found with the relaxations either"


def run(
    monkeypatch: pytest.MonkeyPatch, task: ApproachTask, statuses: Sequence[str]
) -> tuple[Candidate, list[Point], list[Any]]:
    """Between neighbours, with a programme that stays where it starts."""
    points, starts = points_of(task), list[Any]()
    left = iter(statuses)

    def programme(_: object, start: Point, following: object) -> ProgrammeEnd:
        assert following == FOLLOWING
        starts.append(start)
        return ProgrammeEnd(next(left), 10 ** len(starts), start.effort, start.placement)

    monkeypatch.setattr(approach, "optima_at", lambda *_: points)
    monkeypatch.setattr(approach, "programme_from", programme)
    answer = between_neighbours(task, kept_by(task), Coupling(task, FOLLOWING))
    return answer, points, starts


@pytest.mark.parametrize(
    ("statuses", "told"),
    [
        (("solved", "stalled"), "solved"),
        (("stalled", "solved"), "solved"),
        (("first", "second"), "warm_start_after_first"),
    ],
)
def test_between_neighbours_the_batch_s_cost_decides(
    monkeypatch: pytest.MonkeyPatch, statuses: Sequence[str], told: str
) -> None:
    task = small_task(1, **RELAXED)
    coupling = Coupling(task, FOLLOWING)
    answer, points, starts = run(monkeypatch, task, statuses)
    assert (answer.iterations, answer.status) == (110, told)
    costs = [coupling.cost(one) for one in (answer, *answer.others)]
    assert costs == sorted(costs)
    assert costs[0] <= coupling.cost(kept_by(task))
    # The programme starts from what was kept, and from the cheapest for the batch.
    cheapest = min(points, key=lambda one: one.effort + coupling.onwards(one.postures[1]))
    assert starts[0].placement.strike_m == pytest.approx(0.0, abs=1e-9)
    assert starts[1] is cheapest
    # What was kept, four of the points, and where each programme ended.
    assert len(costs) == 1 + 4 + 2
    dearest = sorted(points, key=lambda one: one.effort + coupling.onwards(one.postures[1]))[4:]
    told_joints = {one.thinning_joints for one in (answer, *answer.others)}
    assert told_joints.isdisjoint(tuple(one.postures[0].tolist()) for one in dearest)


def test_what_bears_more_comes_first_though_it_is_dearer(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(1, **RELAXED)
    levels = iter([0.0, 0.001, 0.004])
    known = dict[float, float]()

    def level(_: object, candidate: Candidate) -> float:
        return known.setdefault(candidate.effort, next(levels, 0.002))

    monkeypatch.setattr(approach, "_level", level)
    answer, _, _ = run(monkeypatch, task, ("solved", "solved"))
    borne = [known[one.effort] for one in (answer, *answer.others)]
    assert borne == sorted(borne, reverse=True)
    assert borne[0] == 0.004


def test_points_that_bear_more_are_started_from_first(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(1, **RELAXED)
    points = points_of(task)
    dearest = max(points, key=lambda one: one.effort)
    raised = [replace(one, level_m=0.001 if one is dearest else 0.0) for one in points]
    starts = []

    def programme(_: object, start: Point, following: object) -> ProgrammeEnd:
        starts.append(start)
        return ProgrammeEnd("solved", 1, start.effort, start.placement)

    monkeypatch.setattr(approach, "optima_at", lambda *_: raised)
    monkeypatch.setattr(approach, "programme_from", programme)
    between_neighbours(task, kept_by(task), Coupling(task, None))
    assert starts[1].effort == dearest.effort


@pytest.mark.parametrize("wished", [0.0, 0.001, 0.004])
def test_the_level_of_a_candidate_is_the_largest_that_its_margin_bears(wished: float) -> None:
    task = small_task(2, position_margin_m=wished)
    best = best_on_arcs(small_task(2))
    assert best is not None
    arc = best.arc
    joints = task.thinning_joints(best.angle_rad, arc.tool_side, arc.branch)
    candidate = at_angle(task, best.angle_rad, arc.tool_side, arc.branch, joints)
    margin = approach_margin(task, best.angle_rad, arc.tool_side, arc.branch)
    levels = [wished / 2**k for k in range(4)] + [0.0]
    assert _level(task, candidate) == max(level for level in levels if level <= margin)


def test_less_than_needed_is_a_level_below_zero() -> None:
    task = small_task(2)
    uncertain = replace(task, target=replace(task.target, position_std_m=0.05))
    assert _level(uncertain, kept_by(task)) == -1.0


def test_a_candidate_as_a_point_stands_at_thinning_and_standby() -> None:
    task = small_task(1, **RELAXED)
    kept = kept_by(task)
    point = _point(task, kept)
    assert point.postures[0] == pytest.approx(kept.thinning_joints)
    expected = task.postures(kept.approach_angle_rad, 1, point.branch, np.array([0.04, 0.0]))
    assert point.postures == pytest.approx(expected[::-1], abs=1e-9)
    seen = point.placement
    assert seen.approach_angle_rad == pytest.approx(kept.approach_angle_rad)
    assert seen.strike_m == pytest.approx(0.0, abs=1e-9)
    assert seen.tilt_rad == pytest.approx(0.0, abs=1e-7)
    assert (point.tool_side, point.branch, point.effort) == (1, kept.branch, kept.effort)
    assert point.level_m == 0.0


@pytest.mark.parametrize("turns", [-1, 0, 1])
@pytest.mark.parametrize("beyond", [-2.0, -0.2, 0.5, 1.2, 2.0])
def test_an_end_is_brought_to_the_nearest_of_its_arc(turns: int, beyond: float) -> None:
    """Shares of the arc, from its middle to an end; whole turns do not count."""
    task = small_task(1, **RELAXED)
    kept = kept_by(task)
    best = best_on_arcs(task)
    assert best is not None
    arc = best.arc
    middle, half = (arc.lower_rad + arc.upper_rad) / 2, (arc.upper_rad - arc.lower_rad) / 2
    angle = middle + beyond * half
    seen = Placement(angle + 2 * np.pi * turns, 0.0, np.zeros(3))
    found = _on_its_arc(task, _point(task, kept), ProgrammeEnd("solved", 1, 1.0, seen))
    expected = middle + np.clip(beyond, -1.0, 1.0) * half
    near = [one for one in found if abs(one.approach_angle_rad - expected) < 1e-6]
    assert len(near) == 1
    assert (near[0].tool_side, near[0].branch) == (arc.tool_side, arc.branch)
    joints = fixed_task(task, 0.0, np.zeros(3)).thinning_joints(expected, 1, arc.branch)
    assert near[0].thinning_joints == pytest.approx(joints, abs=1e-6)


def test_no_arc_of_the_start_s_branch_offers_nothing() -> None:
    task = small_task(1, **RELAXED)
    start = replace(_point(task, kept_by(task)), branch=7)
    seen = Placement(0.1, 0.0, np.zeros(3))
    assert _on_its_arc(task, start, ProgrammeEnd("solved", 1, 1.0, seen)) == []
