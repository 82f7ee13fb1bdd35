import numpy as np

from bench.kernels import posture
from bench.reference import build_ladder, ladder_effort, sweep_targets, sweep_task
from bench.targets import data_set_3, random_set
from solver import solve
from solver.approach.optimum.batch import closed_form_optima
from solver.kinematics.forward import forward_kinematics


def test_postures_put_the_tool_where_it_has_to_be() -> None:
    targets = random_set(1, 60)
    problem = targets.problem(limit_margin_rad=0.0)
    task, frames = sweep_task(problem, 24), targets.frames
    q, checked = np.empty(6), 0
    for frame in frames:
        for cos, sin in zip(task.cosines, task.sines, strict=True):
            z = cos * frame[6:9] + sin * frame[9:12]
            y = frame[3:6]
            axes = (tuple(np.cross(y, z)), tuple(y), tuple(z))
            for branch in range(8):
                if not posture(task, frame, axes, 0.02, branch, q):
                    continue
                checked += 1
                pose = forward_kinematics(problem.robot, problem.mounted_tool, q)
                np.testing.assert_allclose(pose[:3, :3], np.column_stack(axes), atol=1e-9)
                np.testing.assert_allclose(pose[:3, 3], frame[:3] - 0.02 * z, atol=1e-12)
    assert checked > 200


def test_finer_sweeps_come_closer_to_the_optimum_and_never_below() -> None:
    targets = random_set(2, 40)
    problem = targets.problem()
    found = closed_form_optima(
        problem, targets.positions, targets.directions, np.asarray(problem.start)
    )
    coarse = sweep_targets(problem, targets, 64).at_rows
    fine = sweep_targets(problem, targets, 1024)
    reached = np.isfinite(coarse)
    assert reached.sum() > 10
    assert np.all(fine.at_rows <= coarse)
    assert np.all(fine.at_rows <= fine.between_rows)
    assert np.all(found.efforts[reached] <= fine.at_rows[reached] * (1 + 1e-9))
    assert np.all(fine.at_rows[reached] <= found.efforts[reached] + 0.05)


def test_a_ladder_graph_is_no_dearer_than_greedy_on_its_nodes() -> None:
    targets = data_set_3()
    problem = targets.problem(method="floating_z", order="given", samples=72)
    ladder = build_ladder(problem, targets, 72)
    assert ladder.reached.all()
    greedy = solve(problem)
    assert greedy.planned == len(targets)
    total = sum(approach.effort or 0.0 for approach in greedy.approaches)
    assert ladder_effort(problem, ladder) <= total * (1 + 1e-12)
