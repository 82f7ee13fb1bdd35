"""`path-points`: how straight motion through 2 to 20 postures of the cut-in is (T 4.3.2)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from solver.approach.cut_in.cut_in import line_deviation
from solver.comparison.approach_contest import (
    BETWEEN_ROWS,
    Answer,
    Variant,
    approach_contest,
    chosen,
    comparable,
)
from solver.comparison.contest import Account, Contest
from solver.comparison.scenarios.data_sets import THESIS, data_set_3
from solver.kinematics.forward import forward_kinematics
from solver.methods.registry import METHODS
from solver.problem.problem import Problem
from solver.robots.model import Array

COUNTS: Final = (2, 3, 5, 10, 15, 20)
METHOD: Final = "floating_z"
EQUAL_SPEED: Final = "deviation_at_equal_speed_m"
"""How far the tool leaves the straight cut-in where motors turn as T's did (T 4.2.2)."""


def path_points_contest(methods: Sequence[str] | None) -> Contest:
    """The contest of numbers of cut-in rows; None: all of these.

    Raises:
        UnknownEntrant: there is no such entrant.
    """
    problem = data_set_3().problem()
    variants = [
        Variant(
            f"{METHOD} {count} points",
            f"{count} postures from standby to thinning, joints in a line between them",
            comparable(problem, method=METHOD, path_points=count),
            METHODS[METHOD].solve,
        )
        for count in COUNTS
    ]
    contest = approach_contest(
        problem,
        chosen(variants, methods),
        scenario="path-points",
        title="Numbers of postures along the cut-in, and how far the tool leaves the straight line",
        origin=f"{THESIS}, 4.3.2, on its data set 3 by the floating z-axis method.",
        notes=(
            "T: without points the path was an arc; two and five improved it somewhat, ten brushed "
            "the branch at times, twenty were free of collisions.",
            f"{BETWEEN_ROWS} is of joints that move in a line from posture to posture, and arrive "
            f"together; {EQUAL_SPEED} of joints that move at one speed and stop one after the "
            "other, as T's motors did; path_deviation_m of the cut-in as it is executed here, "
            "refined until it is straight.",
        ),
        reference=variants[-1].name,
        findings=_findings,
    )

    def account(name: str, k: int, answer: Answer) -> Account:
        found = contest.account(name, k, answer)
        if not found.solved or answer.rows is None:
            return found
        deviation = _deviation_at_equal_speed(problem, answer.rows)
        return replace(found, residuals={**found.residuals, EQUAL_SPEED: deviation})

    return replace(contest, account=account)


def _deviation_at_equal_speed(problem: Problem, rows: Array) -> float:
    """How far the tool leaves the line when all joints turn at one speed, each until it is there.

    Args:
        problem: the arm and its tool.
        rows: postures, shape (n, joints) [rad].

    Returns:
        The largest distance [m].
    """
    corners = [rows[:1]]
    for start, step in zip(rows[:-1], np.diff(rows, axis=0), strict=True):
        turned = np.minimum(np.sort(np.abs(step))[:, None], np.abs(step))
        corners.append(start + np.sign(step) * turned)
    pose = forward_kinematics(problem.robot, problem.mounted_tool, rows[-1])
    through = np.concatenate(corners)
    return line_deviation(problem.robot, problem.mounted_tool, through, pose[:3, 3], pose[:3, 2])


def _findings(accounts: Mapping[tuple[str, str], Account]) -> tuple[str, ...]:
    told = []
    for name in dict.fromkeys(entrant for _, entrant in accounts):
        found = [
            account.residuals
            for (_, entrant), account in accounts.items()
            if entrant == name and account.solved
        ]
        if found:
            line, speed = (
                1000 * max(one[what] for one in found) for what in (BETWEEN_ROWS, EQUAL_SPEED)
            )
            told.append(
                f"{name}: the tool leaves the straight line by up to {line:.3g} mm with joints "
                f"that arrive together, by up to {speed:.3g} mm with joints at equal speed."
            )
        else:
            told.append(f"{name}: no target was reached.")
    return tuple(told)
