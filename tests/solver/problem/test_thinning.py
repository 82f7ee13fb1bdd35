"""The 5-8 pattern, against a count by hand in whole millimetres and on properties of any branch."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Blossom, BlossomBranch, InvalidProblem, PlacedBlossom, select_blossoms
from solver.problem.thinning import MOST_FAULTS
from solver.robots.model import Array

LENGTH_MM = 400

millimetres = st.lists(st.integers(0, LENGTH_MM), max_size=40)
coordinates = st.floats(-2.0, 2.0)


def straight(distances_m: list[float]) -> BlossomBranch:
    blossoms = [Blossom(str(k), distance) for k, distance in enumerate(distances_m)]
    return BlossomBranch("b", [(0.2, 0.0, 0.3), (0.2, LENGTH_MM / 1000, 0.3)], blossoms)


def kept_mm(at_mm: list[int]) -> list[int]:
    keepers = select_blossoms([straight([mm / 1000 for mm in at_mm])]).keepers
    return [round(1000 * one.distance_m) for one in keepers]


def fruiting_window(mm: int) -> int | None:
    """The number of the 5 cm window a place is in, walked window by window; None in a bare one."""
    begin, number = 50, 0
    while begin <= mm:
        if mm < begin + 50:
            return number
        begin, number = begin + 50 + 80, number + 1
    return None


@st.composite
def branches(draw: st.DrawFn) -> BlossomBranch:
    """Bent branches of segments from a millimetre up, blossoms anywhere on them."""
    points = draw(
        st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=2, max_size=6)
    )
    steps = [math.dist(one, two) for one, two in itertools.pairwise(points)]
    if min(steps) < 1e-3:
        points = [(0.0, 0.0, 0.0), (0.3, 0.1, 0.0), (0.3, 0.1, 0.2)]
        steps = [math.hypot(0.3, 0.1), 0.2]
    shares = draw(st.lists(st.floats(0.0, 1.0), max_size=20))
    blossoms = [Blossom(str(k), share * sum(steps)) for k, share in enumerate(shares)]
    return BlossomBranch("b", points, blossoms)


def test_windows_by_hand() -> None:
    """One blossom every centimetre, on the boundaries of all windows."""
    assert kept_mm(list(range(0, 400, 10))) == [50, 90, 180, 220, 310, 350]


@pytest.mark.parametrize(
    ("at_mm", "kept"),
    [
        ([], []),
        ([0, 49], []),
        ([49, 50], [50]),  # half-open: 5 cm begins the first fruiting window
        ([99, 100], [99]),  # and 10 cm is in the bare one
        ([179, 180], [180]),
        ([229, 230], [229]),
        ([70], [70]),  # alone in its window: its first and its last
        ([60, 80], [60, 80]),
        ([60, 70, 80], [60, 80]),
        ([80, 60, 70], [60, 80]),  # in any order
        ([60, 60, 60], [60, 60]),
        ([110, 150, 178], []),
    ],
)
def test_few_blossoms(at_mm: list[int], kept: list[int]) -> None:
    assert kept_mm(at_mm) == kept


@given(millimetres)
def test_first_and_last_of_every_fruiting_window_stay(at_mm: list[int]) -> None:
    selection = select_blossoms([straight([mm / 1000 for mm in at_mm])])
    windows: dict[int, list[int]] = {}
    for mm in sorted(at_mm):
        if (number := fruiting_window(mm)) is not None:
            windows.setdefault(number, []).append(mm)
    expected = [mm for inside in windows.values() for mm in _ends(inside)]
    assert [round(1000 * one.distance_m) for one in selection.keepers] == expected
    everything = sorted((*selection.targets, *selection.keepers), key=lambda one: int(one.id))
    assert [one.id for one in everything] == [str(k) for k in range(len(at_mm))]


def _ends(inside: list[int]) -> list[int]:
    return inside if len(inside) == 1 else [inside[0], inside[-1]]


@given(branches())
def test_blossoms_are_on_their_branch_with_its_direction(branch: BlossomBranch) -> None:
    selection = select_blossoms([branch])
    points = np.array(branch.points_m)
    placed = (*selection.targets, *selection.keepers)
    assert len(placed) == len(branch.blossoms)
    for one in placed:
        assert math.hypot(*one.branch_direction) == pytest.approx(1.0, abs=1e-12)
        assert one.branch_id == branch.id
        assert _walked(points, one.distance_m) == pytest.approx(one.position_m, abs=1e-9)
        assert _along_a_segment_there(points, one)


def _walked(points: Array, distance: float) -> Array:
    """Where a walk along the polyline ends, step by step."""
    for start, end in itertools.pairwise(points):
        length = float(np.linalg.norm(end - start))
        if distance <= length:
            return np.asarray(start + (end - start) * distance / length)
        distance -= length
    return np.asarray(points[-1])


def _along_a_segment_there(points: Array, one: PlacedBlossom) -> bool:
    steps = np.diff(points, axis=0)
    units = steps / np.linalg.norm(steps, axis=1)[:, None]
    same = np.linalg.norm(units - one.branch_direction, axis=1) < 1e-9
    ahead = (np.asarray(one.position_m) - points[:-1]) * units
    along = ahead.sum(axis=1)
    inside = (along >= -1e-9) & (along <= np.linalg.norm(steps, axis=1) + 1e-9)
    return bool((same & inside).any())


@given(branches())
def test_targets_come_from_origin_to_tip(branch: BlossomBranch) -> None:
    selection = select_blossoms([branch])
    for found in (selection.targets, selection.keepers):
        distances = [one.distance_m for one in found]
        assert distances == sorted(distances)


def test_direction_at_a_corner_and_at_the_tip() -> None:
    points = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.1, 0.0)]
    blossoms = [Blossom("before", 0.04), Blossom("corner", 0.1), Blossom("tip", 0.2)]
    selection = select_blossoms([BlossomBranch("b", points, blossoms)])
    found = {one.id: one for one in (*selection.targets, *selection.keepers)}
    assert found["before"].branch_direction == (1.0, 0.0, 0.0)
    assert found["corner"].branch_direction == (0.0, 1.0, 0.0)
    assert found["tip"].branch_direction == (0.0, 1.0, 0.0)
    assert found["tip"].position_m == pytest.approx((0.1, 0.1, 0.0))


def test_branches_are_thinned_each_on_its_own() -> None:
    one = straight([0.06, 0.07, 0.08])
    two = BlossomBranch(
        "c", one.points_m, [Blossom(f"c{b.id}", b.distance_m) for b in one.blossoms]
    )
    selection = select_blossoms([one, two])
    assert [target.id for target in selection.targets] == ["1", "c1"]
    assert [keeper.branch_id for keeper in selection.keepers] == ["b", "b", "c", "c"]


LINE = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0)]
Bad = Callable[[], list[BlossomBranch]]

FAULTS: dict[str, tuple[Bad, str]] = {
    "no branch": (list, "#/branches"),
    "no point": (lambda: [BlossomBranch("b", [], [])], "#/branches/0/points_m"),
    "one point": (lambda: [BlossomBranch("b", LINE[:1], [])], "#/branches/0/points_m"),
    "two coordinates": (
        lambda: [BlossomBranch("b", [(0.0, 0.0), (1.0, 0.0)], [])], "#/branches/0/points_m/1"),
    "no length": (
        lambda: [BlossomBranch("b", [LINE[0], LINE[0]], [])], "#/branches/0/points_m/1"),
    "a point twice": (
        lambda: [BlossomBranch("b", [*LINE, LINE[1]], [])], "#/branches/0/points_m/2"),
    "not finite": (
        lambda: [BlossomBranch("b", [LINE[0], (math.nan, 0.0, 0.0)], [])],
        "#/branches/0/points_m/1"),
    "infinitely long": (
        lambda: [BlossomBranch("b", [(-1e308, 0, 0), (1e308, 0, 0)], [])],
        "#/branches/0/points_m/1"),
    "empty branch id": (lambda: [BlossomBranch("", LINE, [])], "#/branches/0/id"),
    "branch id twice": (
        lambda: [BlossomBranch("b", LINE, []), BlossomBranch("b", LINE, [])], "#/branches/1/id"),
    "empty id": (
        lambda: [BlossomBranch("b", LINE, [Blossom("", 0.1)])], "#/branches/0/blossoms/0/id"),
    "id twice on two branches": (
        lambda: [BlossomBranch(b, LINE, [Blossom("x", 0.1)]) for b in "ab"],
        "#/branches/1/blossoms/0/id"),
    "before the origin": (
        lambda: [BlossomBranch("b", LINE, [Blossom("x", -1e-9)])],
        "#/branches/0/blossoms/0/distance_m"),
    "beyond the tip": (
        lambda: [BlossomBranch("b", LINE, [Blossom("x", 0.300001)])],
        "#/branches/0/blossoms/0/distance_m"),
    "far beyond the tip": (
        lambda: [BlossomBranch("b", LINE, [Blossom("x", 1e308)])],
        "#/branches/0/blossoms/0/distance_m"),
    "distance not finite": (
        lambda: [BlossomBranch("b", LINE, [Blossom("x", math.nan)])],
        "#/branches/0/blossoms/0/distance_m"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_nonsense_is_refused_with_its_place(name: str) -> None:
    bad, pointer = FAULTS[name]
    with pytest.raises(InvalidProblem) as caught:
        select_blossoms(bad())
    assert pointer in {fault.pointer for fault in caught.value.faults}


def test_rounding_at_the_tip_is_no_fault() -> None:
    """A length that was added up elsewhere may differ in its last bits."""
    at_tip = Blossom("tip", math.nextafter(0.3, math.inf))
    selection = select_blossoms([BlossomBranch("b", LINE, [at_tip])])
    (tip,) = (*selection.targets, *selection.keepers)
    assert tip.position_m == pytest.approx((0.3, 0.0, 0.0), abs=1e-9)


def test_number_of_faults_is_bounded() -> None:
    blossoms = [Blossom("", -1.0)] * (2 * MOST_FAULTS)
    with pytest.raises(InvalidProblem) as caught:
        select_blossoms([BlossomBranch("b", LINE, blossoms)])
    assert len(caught.value.faults) == MOST_FAULTS
