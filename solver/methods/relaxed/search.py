"""The approaches of least effort of a relaxed task.

Every zone of the ladder inside the one asked for is solved, smaller ones first. A zone is given
what its smaller neighbours offer and the points of the closed form inside it. From the best of them
the closed form's optimum is descended, which finds the valley; from there the programme goes to its
bottom, where the closed form is asked again. Where that says otherwise, as the programme does not
know all that a cut-in has to hold, the descent goes on. So a larger zone on the ladder is never
dearer than a smaller one, at the level that both bear: what a target may move counts first, and
neither the descent nor the programme looks at it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.approach.task.task import ApproachTask
from solver.methods.relaxed.points import Point, descended, optima_at, optimum_at
from solver.methods.relaxed.programme import programme_from
from solver.methods.relaxed.restoration import restored_points
from solver.methods.relaxed.tolerances import (
    AGREED_EFFORT,
    FIRST_LOOKS,
    MORE_LOOKS,
    POINTS_KEPT,
    TILT_ROUNDING_RAD,
)
from solver.methods.relaxed.zones import in_zone, looked_at, strike_rungs, tilt_rungs, zone_of


@dataclass(frozen=True)
class Offers:
    """What was found in a zone.

    Attributes:
        points: the best first; none where nothing was found.
        iterations: of the programmes, over all zones.
        status: how the programme from the best start ended; empty where none was needed.
    """

    points: tuple[Point, ...]
    iterations: int = 0
    status: str = ""


def relaxed_offers(task: ApproachTask) -> Offers:
    """The approaches of least effort found in a task's zone, different ones, the best first."""
    strikes, tilts = strike_rungs(task.options), tilt_rungs(task.options)
    points = optima_at(task, *looked_at(task)) or _restored(task)
    if not points:
        return Offers(())
    found: dict[tuple[int, int], Offers] = {}
    iterations = 0
    for i, strike_m in enumerate(strikes):
        for j, tilt_rad in enumerate(tilts):
            zone = in_zone(task, strike_m, tilt_rad)
            smaller = [found[at] for at in ((i - 1, j), (i, j - 1)) if at in found]
            known = [point for offers in smaller for point in offers.points]
            inside = [point for point in points if _lies_in(zone, point)]
            found[i, j] = _zone_offers(zone, [*known, *inside])
            iterations += found[i, j].iterations
    return replace(found[len(strikes) - 1, len(tilts) - 1], iterations=iterations)


def _zone_offers(task: ApproachTask, known: Sequence[Point]) -> Offers:
    """A zone's offers: what is known inside it, and what a descent and the programme make of it."""
    if not task.options.relaxed:
        return Offers(_best(known))
    points = known or _restored(task)
    if not points:
        return Offers(())
    below = descended(task, min(points, key=_rank).placement, FIRST_LOOKS)
    start = min([*below, *points], key=_rank)
    end = programme_from(task, start)
    at_end = optimum_at(task, end.placement.strike_m, end.placement.swing_rad)
    best = min([*at_end, start], key=_rank)
    if best.effort > end.effort * (1 + AGREED_EFFORT):
        at_end += descended(task, best.placement, MORE_LOOKS)
    return Offers(_best([*at_end, *below, *points]), end.iterations, end.status)


def _restored(task: ApproachTask) -> list[Point]:
    """Approaches where none was looked at: at points that limits and reach were brought inside."""
    frame, zone = task.frame, zone_of(task.options)
    parts = [restored_points(task.for_kernels(side), zone) for side in task.tool_sides]
    strikes, along, across = np.concatenate(parts).T
    swings = np.outer(along, frame.outward) + np.outer(across, frame.sideways)
    return optima_at(task, strikes, swings)


def _lies_in(task: ApproachTask, point: Point) -> bool:
    strike_m, tilt_rad = zone_of(task.options).tolist()
    seen = point.placement
    return bool(seen.strike_m <= strike_m and seen.tilt_rad <= tilt_rad + TILT_ROUNDING_RAD)


def _rank(point: Point) -> tuple[float, float]:
    return point.rank


def _best(points: Iterable[Point]) -> tuple[Point, ...]:
    """The best points, one for each tool side and branch, the best first."""
    kept: dict[tuple[int, int], Point] = {}
    for point in sorted(points, key=_rank):
        kept.setdefault((point.tool_side, point.branch), point)
    return tuple(kept.values())[:POINTS_KEPT]
