"""Where boxes on floors and the arrows between them go: a layered drawing, and nothing random.

An arrow that passes a floor gets a place of its own on it, as if it were a thin box.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

GAP_X = 22
LANE_WIDTH = 10
SWEEPS = 12
SETTLING = 200


@dataclass(eq=False)
class Place:
    """A box, or the way of an arrow past a floor; `x` is its centre."""

    name: str
    floor: int
    width: float
    is_lane: bool = False
    x: float = 0.0


Ways = dict[tuple[str, str], list[Place]]
Near = Mapping[Place, Sequence[Place]]


@dataclass(frozen=True)
class Plan:
    """Floors from the top, and for every arrow the places it leads by, both ends included."""

    floors: list[list[Place]]
    ways: Ways
    width: float


def _ways(floors: Sequence[list[Place]], arrows: Sequence[tuple[str, str]]) -> Ways:
    """The way of each arrow; lanes are added to the floors that it passes."""
    boxes = {place.name: place for floor in floors for place in floor}
    ways = {}
    for start, end in arrows:
        passed = range(boxes[start].floor + 1, boxes[end].floor)
        lanes = [Place(f"{start} {end}", k, LANE_WIDTH, is_lane=True) for k in passed]
        for lane in lanes:
            floors[lane.floor].append(lane)
        ways[start, end] = [boxes[start], *lanes, boxes[end]]
    return ways


def _spread(row: Sequence[Place], wishes: Sequence[float]) -> None:
    """Give each place the x nearest to its wish, in the least squares, without overlaps."""
    offsets = [0.0]
    for left, right in pairwise(row):
        offsets.append(offsets[-1] + (left.width + right.width) / 2 + GAP_X)
    blocks: list[tuple[float, int]] = []  # of places that touch: their mean, and how many
    for wish, offset in zip(wishes, offsets, strict=True):
        mean, count = wish - offset, 1
        while blocks and blocks[-1][0] > mean:
            before, number = blocks.pop()
            mean = (mean * count + before * number) / (count + number)
            count += number
        blocks.append((mean, count))
    means = [mean for mean, count in blocks for _ in range(count)]
    for place, offset, mean in zip(row, offsets, means, strict=True):
        place.x = mean + offset


def _wishes(row: Sequence[Place], near: Near) -> list[float]:
    """Where each place of a row would stand: amid its neighbours, or amid the row without any."""
    middle = sum(place.x for place in row) / len(row)
    return [
        sum(other.x for other in near[place]) / len(near[place]) if near[place] else middle
        for place in row
    ]


def _crossings(ways: Ways) -> int:
    """How often arrows cross, from floor to floor."""
    steps = [step for way in ways.values() for step in pairwise(way)]
    return sum(
        (upper.x - other_upper.x) * (lower.x - other_lower.x) < 0
        for (upper, lower), (other_upper, other_lower) in combinations(steps, 2)
        if upper.floor == other_upper.floor
    )


def plan_of(
    floors: Sequence[Sequence[tuple[str, float]]], arrows: Sequence[tuple[str, str]]
) -> Plan:
    """Order and place boxes, each a name and a width, so that arrows are short and cross seldom."""
    rows = [[Place(name, k, width) for name, width in floor] for k, floor in enumerate(floors)]
    ways = _ways(rows, arrows)
    above: dict[Place, list[Place]] = {place: [] for row in rows for place in row}
    below: dict[Place, list[Place]] = {place: [] for row in rows for place in row}
    for way in ways.values():
        for upper, lower in pairwise(way):
            below[upper].append(lower)
            above[lower].append(upper)
    for row in rows:
        _spread(row, [0.0] * len(row))
    best, fewest = [list(row) for row in rows], _crossings(ways)
    for sweep in range(SWEEPS):
        down = sweep % 2 == 0
        for row in rows if down else rows[::-1]:
            wishes = _wishes(row, above if down else below)
            wished = sorted(zip(wishes, row, strict=True), key=lambda pair: (pair[0], pair[1].name))
            row[:] = [place for _, place in wished]
            _spread(row, [wish for wish, _ in wished])
        if (count := _crossings(ways)) < fewest:
            best, fewest = [list(row) for row in rows], count
    near = {place: above[place] + below[place] for place in above}
    for _ in range(SETTLING):  # the order stands: now between what is above and below
        for row in best:
            _spread(row, _wishes(row, near))
    left = min(place.x - place.width / 2 for row in best for place in row)
    right = max(place.x + place.width / 2 for row in best for place in row)
    for row in best:
        for place in row:
            place.x -= left
    return Plan(best, ways, right - left)
