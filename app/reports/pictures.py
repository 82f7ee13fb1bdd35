"""The pictures of a comparison, as PNG."""

import io
import warnings
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Final

from matplotlib.figure import Figure

from app.reports.drawings.contest_effort import MOST_PANELS, can_draw_effort, draw_contest_effort
from app.reports.drawings.contest_poses import MOST_POSTURES, draw_contest_poses
from app.reports.drawings.contest_strawberry import draw_strawberry
from app.reports.drawings.contest_times import draw_times
from app.reports.picture import EFFORT, POSES, TIMES, Picture
from solver.comparison.contest import Contest
from solver.comparison.result import Comparison

DOTS_PER_INCH: Final = 95

# Scenarios of mechanisms that are no robot model draw themselves.
MECHANISM_POSES: Final[Mapping[str, Callable[[Comparison], Figure]]] = MappingProxyType(
    {"strawberry": draw_strawberry}
)


def draw_pictures(contest: Contest, comparison: Comparison) -> tuple[Picture, ...]:
    """Those that the contest has something for."""
    return tuple(
        Picture(file, caption, _png(draw)) for file, caption, draw in _wanted(contest, comparison)
    )


def _wanted(
    contest: Contest, comparison: Comparison
) -> Iterator[tuple[str, str, Callable[[], Figure]]]:
    problem = contest.problem
    if problem is not None:
        count = len(problem.targets)
        first = (
            f" at the first {MOST_POSTURES} targets that one reaches"
            if count > MOST_POSTURES
            else ""
        )
        yield (
            POSES,
            f"The posture of each method{first}, a colour a target",
            lambda: draw_contest_poses(comparison, problem),
        )
        if can_draw_effort(problem):
            first = (
                f" of the first {MOST_PANELS} targets that one reaches"
                if count > MOST_PANELS
                else ""
            )
            yield (
                EFFORT,
                f"Effort against approach angle{first}: curves where a branch is feasible in the "
                "whole cut-in, bars its arcs with what ends them (q1 is the first joint), and what "
                "each method chose",
                lambda: draw_contest_effort(comparison, problem),
            )
    if contest.scenario in MECHANISM_POSES:
        draw = MECHANISM_POSES[contest.scenario]
        yield (
            POSES,
            "The posture of each of the paper's methods at the first target that all of them reach",
            lambda: draw(comparison),
        )
    yield (
        TIMES,
        "Time against effort, a point a target; answers that do not hold are crosses at the top",
        lambda: draw_times(comparison),
    )


def _png(draw: Callable[[], Figure]) -> bytes:
    written = io.BytesIO()
    with warnings.catch_warnings():
        # Ids may be in any script; what the font does not have is drawn as a box.
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from")
        draw().savefig(written, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    return written.getvalue()
