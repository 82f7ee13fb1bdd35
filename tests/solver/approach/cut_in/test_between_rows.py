"""The quick look between rows may cry wolf, but must not sleep."""

import numpy as np

from solver import Options, Problem, Robot
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.cut_in.between_rows import may_fall_below_zero_between
from solver.approach.optimum.batch import chosen_paths
from solver.approach.task.packing import packed_problem
from solver.approach.task.task import approach_task
from tests.solver.problems import random_targets


def test_a_limit_broken_between_rows_is_suspected(tabletop: Robot) -> None:
    options = Options(path_points=4, standoff_m=0.1, include=("path",))
    problem = Problem(tabletop, random_targets(61, 150), options=options)
    places, arcs, angles = [], [], []
    found = feasible_arcs(problem)
    for k, target in enumerate(problem.targets):
        for arc in found[target.id]:
            # Beside an arc's end a joint is close to a limit.
            for share in (1e-6, 0.5):
                places.append(k)
                arcs.append(arc)
                angles.append(arc.lower_rad + share * (arc.upper_rad - arc.lower_rad))
    paths = chosen_paths(problem, packed_problem(problem)[:, places], arcs, np.array(angles))
    broken = 0
    for k, arc, angle, suspicious in zip(places, arcs, angles, paths.suspicious, strict=True):
        task = approach_task(problem, problem.targets[k], problem.start)
        retreats = np.linspace(options.standoff_m, 0.0, 301)
        rows = task.postures(angle, arc.tool_side, arc.branch, retreats)
        outside = float(np.maximum(task.lower - rows, rows - task.upper).max())
        if outside > 1e-9:
            broken += 1
            assert suspicious, (k, outside)
    assert broken >= 5
    assert np.mean(paths.suspicious) < 0.5


def test_a_rate_that_is_as_high_as_it_may_be_at_standby_is_suspected() -> None:
    """Rooms of a cut-in beside a straight wrist, where 250.7 rad/m were met behind standby."""
    room = np.array([4e-16, 0.00376, 0.01223, 0.02161, 0.03135, 0.04148, 0.05204, 0.06311])
    assert may_fall_below_zero_between(room)
    assert may_fall_below_zero_between(room[::-1].copy())
    assert not may_fall_below_zero_between(room + 0.01)
