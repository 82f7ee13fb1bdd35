"""The search for a slide's place on efforts that are told, position by position."""

import itertools
import math
from collections.abc import Callable
from types import SimpleNamespace

import pytest

from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.kinematics.families.on_rail import split_rail
from solver.methods import slide
from solver.methods.rail import rail_effort, rail_positions
from solver.methods.slide import _Slide, cheapest_position
from tests.solver.methods.on_rail import TARGETS, task_of

TASK = task_of(TARGETS[0])
_FOUND = split_rail(TASK.robot)
assert _FOUND is not None
RAIL: Rail = _FOUND
GRID = sorted(float(place) for place in rail_positions(TASK))
STEP = max(high - low for low, high in itertools.pairwise(GRID))
LOWER, UPPER = float(TASK.lower[0]), float(TASK.upper[0])


def run(
    monkeypatch: pytest.MonkeyPatch, total: Callable[[float], float]
) -> tuple[tuple[float, int] | None, list[float]]:
    """Where the total effort of each place is told, the slide's travel among it."""
    asked: list[float] = []

    def best(task: ApproachTask) -> object:
        place = sum(
            (here - there) * along
            for here, there, along in zip(
                task.robot.mount_position_m, RAIL.arm.mount_position_m, RAIL.axis, strict=True
            )
        )
        asked.append(place)
        effort = total(place)
        if math.isinf(effort):
            return None
        return SimpleNamespace(effort=effort - rail_effort(TASK, place), refined=3)

    monkeypatch.setattr(slide, "best_on_arcs", best)
    return cheapest_position(TASK, RAIL), asked


@pytest.mark.parametrize("lowest", [0.123456, -0.3391, 0.1])
def test_the_bottom_of_a_valley_is_found(monkeypatch: pytest.MonkeyPatch, lowest: float) -> None:
    found, asked = run(monkeypatch, lambda place: 5.0 + abs(place - lowest))
    assert found is not None
    assert found[0] == pytest.approx(lowest, abs=2e-8)
    assert found[1] == 3 * len(asked)
    # The grid, and two looks for each time a step is halved, down to 1e-8. Where the reference is
    # all but one of the grid's places a second minimum may be looked around, down to 1e-3.
    coarse, fine = math.ceil(math.log2(STEP / 1e-3)), math.ceil(math.log2(1e-3 / 1e-8))
    assert len(asked) <= len(GRID) + 2 * (2 * coarse + fine)
    assert all(LOWER - 1e-12 <= place <= UPPER + 1e-12 for place in asked)


@pytest.mark.parametrize("end", [LOWER, UPPER])
def test_the_slide_stays_on_its_rail(monkeypatch: pytest.MonkeyPatch, end: float) -> None:
    found, asked = run(monkeypatch, lambda place: 5.0 + abs(place - 3 * end))
    assert found is not None
    assert found[0] == end
    assert all(LOWER - 1e-12 <= place <= UPPER + 1e-12 for place in asked)


@pytest.mark.parametrize("deepest", range(5))
def test_the_four_lowest_of_the_grid_are_looked_around(
    monkeypatch: pytest.MonkeyPatch, deepest: int
) -> None:
    """Where each of five minima has a deeper place beside it the deepest of four is found."""
    minima = [GRID[k] for k in (2, 7, 12, 17, 22)]

    def total(place: float) -> float:
        values = [5.0 + 0.01 * k + 3 * abs(place - at) for k, at in enumerate(minima)]
        # A narrow well that no place of the grid shows.
        well = minima[deepest] + STEP / 4
        return min(*values, 4.0 + 100 * abs(place - well))

    found, _ = run(monkeypatch, total)
    assert found is not None
    expected = minima[deepest] + STEP / 4 if deepest < 4 else minima[0]
    assert found[0] == pytest.approx(expected, abs=1e-6)


def test_places_from_which_travel_alone_is_too_dear_are_not_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The reference, at 0.1, is the cheapest: whatever travels further than 0.2 is not asked."""
    found, asked = run(monkeypatch, lambda place: 0.2 + 2 * abs(place - 0.1))
    assert found is not None
    assert found[0] == pytest.approx(0.1)
    assert asked[0] == pytest.approx(0.1)
    assert max(abs(place - 0.1) for place in asked) <= 0.2
    assert len([place for place in asked if abs(place - 0.1) > 1.001 * STEP]) >= 2


def test_where_efforts_jump_the_edge_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    edge = GRID[9] + 0.37 * STEP
    found, _ = run(monkeypatch, lambda place: math.inf if place > edge else 5.0 - place)
    assert found is not None
    assert edge - 1e-7 <= found[0] <= edge


def test_nothing_where_no_place_has_an_approach(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(monkeypatch, lambda place: math.inf)[0] is None


def test_steps_are_halved_and_the_better_place_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    of = _Slide(TASK, RAIL)
    assert of.refined == 0

    def effort(place: float) -> float:
        asked.append(place)
        return abs(place - 0.0512)

    monkeypatch.setattr(of, "effort", effort)
    place, least = of.lowest_around(0.0, 0.0512, 0.08, 0.01)
    assert asked == pytest.approx([-0.04, 0.04, 0.02, 0.06, 0.05, 0.07])
    assert [place, least] == pytest.approx([0.05, 0.0012])
