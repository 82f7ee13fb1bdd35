import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.relaxation import placement, shortened
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.forward import forward_kinematics
from solver.methods.relaxed.points import angle_in, descended, fixed_task, optima_at, optimum_at
from tests.solver.problems import random_targets


def tasks(robot: Robot, **options: object) -> list[ApproachTask]:
    chosen = Options(strike_zone_m=0.03, tilt_tolerance_rad=0.3, **options)  # type: ignore[arg-type]
    problem = Problem(robot, random_targets(seed=84, count=40), options=chosen)
    return [approach_task(problem, target, problem.start) for target in problem.targets]


def drawn(
    task: ApproachTask, rng: np.random.Generator, count: int
) -> tuple[np.ndarray, np.ndarray]:
    across = rng.uniform(-0.3, 0.3, size=(count, 2)) @ (task.frame.outward, task.frame.sideways)
    return rng.uniform(0.0, 0.03, count), np.stack([shortened(swing, 0.3) for swing in across])


@pytest.mark.parametrize("margin_m", [0.0, 0.002])
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_point_is_an_unrelaxed_task_and_stands_where_it_says(
    tabletop: Robot, symmetric: bool, margin_m: float
) -> None:
    rng, seen = np.random.default_rng(85), 0
    for task in tasks(tabletop, symmetric_tool=symmetric, position_margin_m=margin_m):
        strikes, swings = drawn(task, rng, 3)
        for strike, swing in zip(strikes, swings, strict=True):
            fixed = fixed_task(task, strike, swing)
            expected = best_on_arcs(fixed)
            points = optima_at(task, np.array([strike]), swing[None])
            assert len(points) == (expected is not None)
            if expected is None:
                continue
            (point,) = points
            seen += 1
            # Where parts end that bear a margin is closed in on from inside, along two ways.
            assert point.effort == pytest.approx(expected.effort, rel=1e-6 if margin_m else 1e-9)
            pose = forward_kinematics(task.robot, task.tool, point.postures[0])
            target = np.asarray(task.target.position_m)
            found = placement(task.frame, target, point.tool_side, pose)
            assert found.strike_m == pytest.approx(strike, abs=1e-9)
            assert found.swing_rad == pytest.approx(swing, abs=1e-9)
            turned = found.approach_angle_rad - point.placement.approach_angle_rad
            assert np.cos(turned) == pytest.approx(1.0, abs=1e-12)
            here = fixed.frame.direction(angle_in(fixed, task, point.placement))
            assert here == pytest.approx(pose[:3, 2], abs=1e-9)
            behind = forward_kinematics(task.robot, task.tool, point.postures[1])
            offset = pose[:3, 3] - behind[:3, 3]
            assert offset == pytest.approx(task.options.standoff_m * pose[:3, 2], abs=1e-9)
    assert seen >= 15


def test_a_descent_stays_in_its_zone_and_never_climbs(tabletop: Robot) -> None:
    rng, gained = np.random.default_rng(86), 0
    for task in tasks(tabletop, position_margin_m=0.0):
        for start in optima_at(task, *drawn(task, rng, 2)):
            (end,) = descended(task, start.placement, 60)
            assert end.effort <= start.effort * (1 + 1e-12)
            assert 0.0 <= end.placement.strike_m <= 0.03
            assert end.placement.tilt_rad <= 0.3 + 1e-12
            gained += end.effort < 0.99 * start.effort
    assert gained >= 10


def test_what_lies_outside_a_zone_is_brought_into_it(tabletop: Robot) -> None:
    task = tasks(tabletop)[0]
    for point in optimum_at(task, 1.0, 2.0 * task.frame.outward):
        assert point.placement.strike_m == 0.03
        assert point.placement.tilt_rad == pytest.approx(0.3)
