"""How far a target should be free to move: levels from what is wished for to what is needed.

Where no approach bears the whole of `position_margin_m`, half of it, a quarter or an eighth is
better than nothing. What a target's standard deviation needs is never given up.
"""

from collections.abc import Iterable, Sequence

from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.robustness import approach_margin, arcs_bearing, needed_margin
from solver.approach.uncertainty.tolerances import LEVEL_ROUNDING_M, MARGIN_HALVINGS
from solver.problem.options import Options
from solver.problem.solution import Arc
from solver.problem.targets import Target


def margin_levels(options: Options, target: Target) -> tuple[float, ...]:
    """Displacement margins to try, the largest first, the last one needed [m]."""
    needed, wished = needed_margin(target), options.position_margin_m or 0.0
    if wished == 0.0:
        return (needed,)
    parts = (*(wished / 2**k for k in range(MARGIN_HALVINGS + 1)), 0.0)
    return tuple(sorted({max(part, needed) for part in parts}, reverse=True))


def level_borne(levels: Sequence[float], margin: float) -> float | None:
    """The largest of the levels that a displacement margin bears; None: not even the last [m]."""
    return next((level for level in levels if margin >= level - LEVEL_ROUNDING_M), None)


def told_level(
    options: Options, target: Target, margin: float | None
) -> tuple[float | None, bool | None]:
    """What an approach of some displacement margin [m] tells: its level, and True if that is short.

    Nothing where nothing is asked for, or where nobody knows the margin.
    """
    wished = options.position_margin_m
    if margin is None or not wished:
        return None, None
    level = level_borne(margin_levels(options, target), margin) or 0.0
    return level, True if level < wished else None


def arcs_at_level(task: ApproachTask, arcs: Sequence[Arc]) -> tuple[Arc, ...]:
    """The parts of a task's feasible arcs that bear the largest level that some part bears."""
    *wished, _ = margin_levels(task.options, task.target)
    found = (arcs_bearing(task, arcs, level) for level in wished)
    return next((parts for parts in found if parts), tuple(arcs))


def first_at_level(task: ApproachTask, places: Iterable[tuple[float, int, int]]) -> int | None:
    """Which of some feasible approaches bears the largest level, the first of several.

    Args:
        task: their task.
        places: approach angle [rad], tool side and branch of each, the best first.

    Returns:
        Its place; None where none bears what the target's uncertainty needs.
    """
    levels = margin_levels(task.options, task.target)
    chosen, best = None, -1.0
    for k, (angle, tool_side, branch) in enumerate(places):
        if levels == (0.0,):
            return k
        level = level_borne(levels, approach_margin(task, angle, tool_side, branch))
        if level is not None and level > best:
            chosen, best = k, level
        if best == levels[0]:
            break
    return chosen
