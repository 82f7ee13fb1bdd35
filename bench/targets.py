"""Seeded targets, and the thesis's data set 3, as problems and as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.schemas.demo_request import demo_request
from solver import Options, Problem, Target, load_robot
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.approach.task.frame import approach_frames
from solver.comparison.targets import drawn_at_edges, drawn_in_box

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TargetSet:
    """Positions and branch directions of n targets, shape (n, 3) each [m, any length]."""

    positions: Array
    directions: Array

    def __len__(self) -> int:
        return len(self.positions)

    def __getitem__(self, chosen: Any) -> "TargetSet":
        return TargetSet(self.positions[chosen], self.directions[chosen])

    def problem(self, **options: Any) -> Problem:
        """A problem of the table-top arm; targets are named by their index, options by keyword.

        Without `position_margin_m` unless one is given: references and peers have none.
        """
        rows = zip(self.positions.tolist(), self.directions.tolist(), strict=True)
        targets = [Target(str(k), tuple(p), tuple(d)) for k, (p, d) in enumerate(rows)]
        return Problem(
            load_robot("tabletop"),
            targets,
            options=Options(**({"position_margin_m": 0.0} | options)),
        )

    @property
    def frames(self) -> Array:
        """Position, y axis, approach directions at angle 0 and a quarter turn, shape (n, 12)."""
        branch, outward, sideways = approach_frames(self.positions, self.directions)
        return np.concatenate((self.positions, branch, outward, sideways), axis=1)


def random_set(seed: int, count: int) -> TargetSet:
    """Targets anywhere in the box, branches in every direction; half have no approach."""
    return TargetSet(*drawn_in_box(seed, count))


def hard_set(seed: int, count: int) -> TargetSet:
    """Targets at the edges of what the arm can do, all reached by some thinning posture."""
    problem = data_set_3().problem()
    margin = problem.options.limit_margin_rad
    return TargetSet(*drawn_at_edges(problem.robot, problem.mounted_tool, margin, seed, count))


def together(*sets: TargetSet) -> TargetSet:
    """Several sets as one."""
    return TargetSet(
        np.concatenate([one.positions for one in sets]),
        np.concatenate([one.directions for one in sets]),
    )


def reachable_set(seed: int, count: int) -> TargetSet:
    """Targets of the box for which the closed form has an approach."""
    drawn = random_set(seed, 4 * count + 20)
    reached = np.flatnonzero(feasible(drawn))[:count]
    assert len(reached) == count, "nearly half of the box can be reached"
    return drawn[reached]


def feasible(targets: TargetSet) -> NDArray[np.bool_]:
    """Which targets the closed form has an approach for, shape (n,)."""
    problem = targets[:1].problem()
    found = closed_form_optima(
        problem, targets.positions, targets.directions, np.asarray(problem.start)
    )
    return np.asarray(found.branches != NO_BRANCH)


def data_set_3() -> TargetSet:
    """T's data set 3, five targets."""
    rows: Sequence[dict[str, list[float]]] = demo_request()["targets"]
    return TargetSet(
        np.array([entry["position_m"] for entry in rows]),
        np.array([entry["branch_direction"] for entry in rows]),
    )
