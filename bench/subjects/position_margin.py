"""What a millimetre of freedom of the targets costs: time, effort, and targets, of which none."""

from functools import partial

import numpy as np

from bench.measure import Row, alternating, row, scaled
from bench.targets import TargetSet, random_set, reachable_set
from solver import Plan, solve

MARGIN_M = 0.001


def measure(quick: bool) -> list[Row]:
    """Random targets with a margin and without; time is that of targets that can be reached."""
    targets = random_set(14, 60 if quick else 3000)
    exact, free = (planned(targets, "independent", margin_m) for margin_m in (0.0, MARGIN_M))
    pairs = [
        (two.effort / one.effort, two.position_margin_m or 0.0)
        for one, two in zip(exact.approaches, free.approaches, strict=True)
        if one.effort is not None and two.effort is not None
    ]
    dearer, levels = np.array(pairs).T
    return [
        row(
            "planned without the margin and not with it",
            float(exact.planned - free.planned),
            "targets",
            runs=exact.planned,
            at_most=0.0,
        ),
        row(
            "effort above that without, all together",
            100 * (free.total_effort / exact.total_effort - 1),
            "%",
            runs=len(dearer),
            at_most=1.0,
        ),
        row("effort above that without, each", scaled(list(dearer - 1), 100), "%"),
        row(
            "targets that bear the whole margin",
            100 * float(np.mean(levels >= MARGIN_M)),
            "%",
            runs=len(levels),
            note="the others bear a half, a quarter, an eighth or nothing of it",
        ),
        *_times(reachable_set(15, 20 if quick else 1000), reachable_set(9, 8 if quick else 100)),
    ]


def planned(targets: TargetSet, order: str, margin_m: float) -> Plan:
    """The plan by `ssas`, untimed."""
    return solve(
        targets.problem(method="ssas", order=order, include=("path",), position_margin_m=margin_m)
    )


def _times(many: TargetSet, few: TargetSet) -> list[Row]:
    actions = {
        f"{order} {margin_m}": partial(planned, targets, order, margin_m)
        for targets, order in ((many, "independent"), (few, "given"))
        for margin_m in (0.0, MARGIN_M)
    }
    times = alternating(actions, 9)
    more = np.subtract(times[f"independent {MARGIN_M}"], times["independent 0.0"]) / len(many)
    return [
        row(
            "time more for a target",
            scaled(more.tolist(), 1e3),
            "ms",
            at_most=0.3,
            note=f"{len(many)} independent targets that can be reached, verified",
        ),
        row(
            f"order given, {len(few)} targets, with the margin",
            scaled(times[f"given {MARGIN_M}"], 1e3),
            "ms",
            at_most=150.0,
        ),
        row(
            f"order given, {len(few)} targets, without",
            scaled(times["given 0.0"], 1e3),
            "ms",
        ),
    ]
