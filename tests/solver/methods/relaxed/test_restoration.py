import numpy as np

from solver import Options, Problem, Robot, Target, solve
from solver.approach.task.task import approach_task
from solver.methods.relaxed.points import optima_at
from solver.methods.relaxed.restoration import KINDS, least_room, restore
from solver.methods.relaxed.zones import looked_at, zone_of
from solver.problem.solution import PLANNED
from tests.solver.problems import random_targets


def test_what_is_restored_holds_and_what_holds_stays(tabletop: Robot) -> None:
    options = Options(strike_zone_m=0.03, tilt_tolerance_rad=0.3)
    problem = Problem(tabletop, random_targets(seed=87, count=30), options=options)
    rng, zone, restored = np.random.default_rng(88), zone_of(options), 0
    values, rows = np.empty(KINDS), np.zeros(KINDS, dtype=np.int64)
    for target in problem.targets:
        kernels = approach_task(problem, target, problem.start).for_kernels(1)
        for branch in range(8):
            x = np.array([rng.uniform(-np.pi, np.pi), rng.uniform(), 0.0, 0.0])
            before = least_room(kernels, zone, x, branch, kernels.retreats, values, rows)
            start = x.copy()
            if not restore(kernels, zone, branch, x):
                continue
            held = least_room(kernels, zone, x, branch, kernels.retreats, values, rows)
            assert held >= 0.0
            assert 0.0 <= x[1] <= 1.0
            assert np.hypot(x[2], x[3]) <= 1.0 + 1e-12
            if before >= 0.0:
                assert np.array_equal(x, start)
            else:
                restored += 1
    assert restored >= 5


def test_a_target_is_rescued_between_the_points_looked_at(tabletop: Robot) -> None:
    options = Options(tilt_tolerance_rad=np.radians(10))
    target = Target(
        "a",
        (0.07557433001331254, -0.22066618510267422, 0.13292250320066307),
        (-0.10001541175059649, 1.0282824624497804, 2.655293570613392),
    )
    problem = Problem(tabletop, [target], options=options)
    task = approach_task(problem, target, problem.start)
    assert not optima_at(task, *looked_at(task))
    (approach,) = solve(problem).approaches
    assert approach.status == PLANNED
    assert approach.tilt_rad is not None
    assert 0.01 < approach.tilt_rad <= np.radians(10)
