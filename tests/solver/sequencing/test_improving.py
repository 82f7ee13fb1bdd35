"""A stop improved by its method: its offers in turn, and what was chosen where none holds."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from solver import Options, Problem, Robot
from solver.approach.optimum.on_arcs import ArcOptimum
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.sequencing import improving
from solver.sequencing.improving import improved_stop
from solver.sequencing.sequence import Stop, sequence
from tests.solver.problems import DATA_SET_3


@pytest.fixture(scope="module")
def stops(tabletop: Robot) -> tuple[Stop, ...]:
    return sequence(Problem(tabletop, DATA_SET_3[:2], Options(method="ssas")))


def offers(stop: Stop, count: int) -> tuple[Candidate, ...]:
    """Candidates that only their numbers tell apart."""
    return tuple(
        replace(stop.candidate, effort=float(k), iterations=10 + k, status=f"{k}")
        for k in range(count)
    )


@pytest.mark.parametrize("broken", [0, 1, 2])
def test_the_first_offer_that_holds_is_taken(
    stops: tuple[Stop, ...], monkeypatch: pytest.MonkeyPatch, broken: int
) -> None:
    first, *others = offers(stops[0], 4)
    asked = []

    def improve(
        task: ApproachTask, start: ArcOptimum, next_thinning: Sequence[float] | None
    ) -> Candidate:
        asked.append((task, start, next_thinning))
        return replace(first, others=tuple(others))

    fails = [str(k) for k in range(broken)]
    monkeypatch.setattr(
        improving, "broken_between", lambda task, one: 0.01 if one.status in fails else None
    )
    found = improved_stop(stops[0].task, stops[0], stops[1], improve)
    # Its own work and status are those of the method's answer, whichever offer it is.
    assert (found.iterations, found.status) == (10, "0")
    assert found.effort == broken
    assert [one.iterations for one in found.others] == list(range(11 + broken, 14))
    ((task, start, next_thinning),) = asked
    assert task is stops[0].task
    assert (start.arc, start.angle_rad) == (stops[0].arc, stops[0].angle_rad)
    assert start.effort == stops[0].candidate.effort
    assert next_thinning == stops[1].candidate.thinning_joints
    improved_stop(stops[1].task, stops[1], None, improve)
    assert asked[1][2] is None


def test_where_none_holds_the_ladder_s_choice_stays(
    stops: tuple[Stop, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    first, *others = offers(stops[0], 3)
    monkeypatch.setattr(improving, "broken_between", lambda task, one: 0.01)
    found = improved_stop(
        stops[0].task, stops[0], None, lambda *_: replace(first, others=tuple(others))
    )
    assert found == replace(stops[0].candidate, status="warm_start_after_broken_limit")
