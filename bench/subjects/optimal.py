"""Order `optimal`: against every order for few targets, against a long search for many."""

import itertools
import math

from bench.measure import Row, row, scaled, times_of
from bench.order_search import efforts_of_orders, long_search
from bench.reference import build_ladder
from bench.subjects.given import planned_effort
from bench.targets import TargetSet, reachable_set
from solver import solve
from solver.sequencing.sequence import sequence

WANTED_GAP = 1e-6
WANTED_S = 3.0
WANTED_ABOVE = 0.03
LADDER_ANGLES = 72
FINE_ANGLES = 144
REFINED = 100


def measure(quick: bool) -> list[Row]:
    """Gaps and seconds."""
    return [
        _every_order((3,) if quick else (3, 4, 5, 6)),
        *_every_order_of_a_ladder(4 if quick else 8, 1 if quick else 3),
        *_long_search(8 if quick else 250, 0.5 if quick else 60.0),
    ]


def effort_of(targets: TargetSet, order: str) -> float:
    """Total effort of a batch that has to be planned as a whole."""
    plan = solve(targets.problem(method="ssas", order=order, include=("path",)))
    return planned_effort(plan) if plan.planned == len(targets) else math.inf


def _every_order(sizes: tuple[int, ...]) -> Row:
    gaps = []
    for size in sizes:
        targets = reachable_set(20 + size, size)
        least = min(
            effort_of(targets[list(order)], "given")
            for order in itertools.permutations(range(size))
        )
        gaps.append(effort_of(targets, "optimal") / least - 1)
    return row(
        "largest gap of optimal to `given` on every order, relative",
        max(gaps),
        "",
        runs=len(gaps),
        at_most=WANTED_GAP,
        note=f"batches of {', '.join(map(str, sizes))} targets",
    )


def _every_order_of_a_ladder(size: int, batches: int) -> list[Row]:
    above, gaps = [], []
    for seed in range(batches):
        targets = reachable_set(40 + seed, size)
        problem = targets.problem()
        targets = targets[build_ladder(problem, targets, FINE_ANGLES).reached]
        orders, efforts = efforts_of_orders(problem, build_ladder(problem, targets, FINE_ANGLES))
        effort = effort_of(targets, "optimal")
        above.append(effort / efforts[0] - 1)
        gaps.append(effort / min(effort_of(targets[one], "given") for one in orders[:REFINED]) - 1)
    about = f"{batches} batches of {size} targets"
    return [
        row(
            f"largest gap of optimal to the {REFINED} best of every order by `given`, relative",
            max(gaps),
            "",
            runs=batches,
            at_most=WANTED_GAP,
            note=f"{about}; all orders ranked on a ladder of {FINE_ANGLES} angles",
        ),
        row(
            "largest effort of optimal above every order and choice of a ladder's nodes, relative",
            max(above),
            "",
            runs=batches,
            at_most=WANTED_GAP,
            note=f"{about}, {FINE_ANGLES} angles; below zero: cheaper",
        ),
    ]


def _long_search(size: int, seconds: float) -> list[Row]:
    targets = reachable_set(60, size + size // 4)
    problem = targets.problem()
    # Without those whose arcs fall between the ladder's angles: the search knows its nodes only.
    targets = targets[build_ladder(problem, targets, LADDER_ANGLES).reached][:size]
    ladder = build_ladder(problem, targets, LADDER_ANGLES)
    order = long_search(problem, ladder, seconds, seed=1)
    reference = effort_of(targets[order], "given")
    asked = targets.problem(method="ssas", order="optimal", include=("path",))
    times = times_of(lambda: sequence(asked), 2)
    return [
        row(
            f"optimal, {len(targets)} targets",
            scaled(times, 1.0),
            "s",
            at_most=WANTED_S,
            note="order, approaches and cut-ins",
        ),
        row(
            f"effort of optimal above a search of {seconds:g} s, {len(targets)} targets",
            effort_of(targets, "optimal") / reference - 1,
            "relative",
            at_most=WANTED_ABOVE,
            note=f"annealing on {len(ladder.thinning)} nodes of {LADDER_ANGLES} angles, then "
            "approaches by `given`; below zero: cheaper",
        ),
    ]
