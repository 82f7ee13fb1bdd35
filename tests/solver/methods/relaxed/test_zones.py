import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.task.task import ApproachTask, approach_task
from solver.methods.relaxed.zones import in_zone, looked_at, strike_rungs, tilt_rungs, zone_of
from tests.solver.problems import random_targets


def some_task(robot: Robot) -> ApproachTask:
    problem = Problem(robot, random_targets(seed=1, count=1), options=Options(standoff_m=0.3))
    return approach_task(problem, problem.targets[0], problem.start)


@pytest.mark.parametrize("strike_m", [0.0, 1e-6, 0.013, 0.02, 0.021, 0.3])
@pytest.mark.parametrize("tilt_rad", [0.0, 1e-6, 0.1, 0.1745, 0.2, 0.8])
def test_zones_and_points_are_nested(tabletop: Robot, strike_m: float, tilt_rad: float) -> None:
    task = in_zone(some_task(tabletop), strike_m, tilt_rad)
    larger = in_zone(task, 1.3 * strike_m, min(1.3 * tilt_rad, 0.8))
    for rungs in (strike_rungs, tilt_rungs):
        own = rungs(task.options)
        assert own[0] == 0.0
        assert list(own) == sorted(set(own))
        assert set(own[:-1]) <= set(rungs(larger.options))
    assert strike_rungs(task.options)[-1] == zone_of(task.options)[0]
    assert tilt_rungs(task.options)[-1] == zone_of(task.options)[1]
    strikes, swings = looked_at(task)
    tilts = np.linalg.norm(swings, axis=1)
    assert strikes[0] == tilts[0] == 0.0
    assert strikes.max() == zone_of(task.options)[0]
    assert tilts.max() == pytest.approx(zone_of(task.options)[1], rel=1e-12)
    assert np.abs(swings @ task.frame.branch).max() < 1e-12
    every = {tuple(row) for row in np.column_stack((looked_at(larger)[0], looked_at(larger)[1]))}
    edge = (strikes == strikes.max()) | (tilts >= tilts.max() * (1 - 1e-12))
    own_points = [tuple(row) for row in np.column_stack((strikes, swings))[~edge]]
    assert set(own_points) <= every
