"""The nearest change is the nearest: nothing shorter is feasible, whichever way."""

from collections.abc import Iterator

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target
from solver.approach.arcs.arcs import task_arcs
from solver.approach.arcs.many import arcs_of_many
from solver.approach.refusal.nearest_change import nearest_displacement
from solver.approach.task.packed import COLUMNS
from solver.approach.task.task import ApproachTask, approach_task

LONGEST_M = 0.0427
"""The shorter displacement that is known for the target below, and what an offer is put inside."""


def in_and_beyond_reach(seed: int, count: int) -> Iterator[Target]:
    """Targets in a ball about the shoulder, a fifth larger than the reach, branches anywhere."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        branch = rng.normal(size=3)
        outward = rng.normal(size=3)
        outward /= np.linalg.norm(outward)
        place = np.array([0.0, 0.0, 0.1]) + 0.5 * rng.uniform() ** (1 / 3) * outward
        yield Target(str(k), tuple(place.tolist()), tuple(branch.tolist()))


def refused(robot: Robot, seed: int, count: int, **options: object) -> Iterator[ApproachTask]:
    """Those of them that no angle reaches."""
    problem = Problem(
        robot,
        list(in_and_beyond_reach(seed, count)),
        options=Options(method="ssas", **options),  # type: ignore[arg-type]
    )
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        if not task_arcs(task):
            yield task


def shorter_ones(task: ApproachTask, most: float, rng: np.random.Generator, count: int) -> int:
    """How many of random displacements shorter than `most` [m] give the target a feasible arc."""
    moves = rng.normal(size=(count, 3))
    moves *= (most * rng.uniform(size=count) ** (1 / 6) / np.linalg.norm(moves, axis=1))[:, None]
    numbers = np.stack([np.tile(task.packed(side).numbers, (count, 1)) for side in task.tool_sides])
    first = COLUMNS["position"]
    numbers[:, :, first : first + 3] += moves
    packed = task.packed(1)
    return len(arcs_of_many(numbers, packed.retreats, packed.cos_steps))


def test_the_shorter_of_two_ways_is_offered(tabletop: Robot) -> None:
    """The offer was 61.2 mm when this was written: its search began on the wrong branch."""
    position = (-0.13793098961239808, -0.21651304193369875, 0.029484405566558725)
    branch = (-0.5550358376356781, -0.45390456621783, -0.5794788807769247)
    problem = Problem(tabletop, [Target("t", position, branch)], options=Options(method="ssas"))
    nearest = nearest_displacement(approach_task(problem, problem.targets[0], problem.start))
    assert nearest is not None
    assert nearest.verified
    assert np.linalg.norm(nearest.displacement_m) <= LONGEST_M


@pytest.mark.parametrize(
    ("seed", "options"),
    [
        (1, {}),
        (2, {"symmetric_tool": True}),
        (3, {"limit_margin_rad": 0.1}),
        (4, {"standoff_m": 0.02}),
        (5, {"standoff_m": 0.07}),
    ],
)
def test_nothing_much_shorter_is_feasible(
    tabletop: Robot, seed: int, options: dict[str, object]
) -> None:
    """An independent search: random displacements of nine tenths of the length, and less."""
    rng = np.random.default_rng(seed)
    compared = 0
    for task in refused(tabletop, seed, 60, **options):
        nearest = nearest_displacement(task)
        assert nearest is not None
        assert nearest.verified
        length = float(np.linalg.norm(nearest.displacement_m))
        assert shorter_ones(task, 0.9 * length, rng, 250) == 0, (task.target, nearest)
        compared += 1
    assert compared > 20
