"""Where on its rail an arm stands cheapest: the closed form's optimum, minimised over the slide."""

import math
from dataclasses import dataclass, field

import numpy as np

from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.methods.tolerances import RAIL_BRACKETS, RAIL_COARSE_M, RAIL_FINE_M


def cheapest_position(task: ApproachTask, rail: Rail) -> tuple[float, int] | None:
    """The slide's position of least effort [m], and cells of the effort that were looked at.

    Every position has its global optimum by the closed form, so one number is left to choose. Its
    effort has kinks, and jumps where an arc begins: around the cheapest local minima of the grid
    the step is halved, which needs no slope, first in all of them and to the end in the best.
    None where no position of the grid has an approach.
    """
    slide = _Slide(task, rail)
    grid = rail_positions(task)
    least = math.inf
    values = {}
    for place in grid.tolist():  # the least travel first: from where it alone is too dear, none
        values[place] = slide.effort(place) if rail_effort(task, place) < least else math.inf
        least = min(least, values[place])
    if math.isinf(least):
        return None
    places = sorted(values)
    efforts = np.array([math.inf, *(values[place] for place in places), math.inf])
    inner = efforts[1:-1]
    low = np.isfinite(inner) & (inner <= efforts[:-2]) & (inner <= efforts[2:])
    minima = sorted(np.flatnonzero(low).tolist(), key=lambda k: float(inner[k]))
    step = float(np.diff(places).max())
    tried = [
        slide.lowest_around(places[k], float(inner[k]), step, RAIL_COARSE_M)
        for k in minima[:RAIL_BRACKETS]
    ]
    place, effort = min(tried, key=lambda one: one[1])
    place, _ = slide.lowest_around(place, effort, RAIL_COARSE_M, RAIL_FINE_M)
    return place, slide.refined


@dataclass
class _Slide:
    """Effort over the slide of one task, and how much work it was."""

    task: ApproachTask
    rail: Rail
    refined: int = field(default=0)

    def effort(self, place: float) -> float:
        """Of the best approach with the slide there; infinite without one."""
        best = best_on_arcs(at_rail(self.task, self.rail, place))
        if best is None:
            return math.inf
        self.refined += best.refined
        return best.effort + rail_effort(self.task, place)

    def lowest_around(
        self, place: float, effort: float, step: float, last_step: float
    ) -> tuple[float, float]:
        """The lowest place found by halving the step around the best [m], and its effort."""
        while step > last_step:
            step /= 2
            for other in (place - step, place + step):
                if self.task.lower[0] <= other <= self.task.upper[0]:
                    there = self.effort(other)
                    if there < effort:
                        place, effort = other, there
        return place, effort
