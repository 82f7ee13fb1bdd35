"""Effort at many angles is that of each angle's thinning posture."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target, load_robot
from solver.approach.arcs.turns import TURN_ROWS, turns_along_path
from solver.approach.optimum.effort_samples import (
    MOST_SAMPLES,
    effort_scratch,
    path_joints,
    sample_effort,
    spread,
)
from solver.approach.task.task import ApproachTask, approach_task
from solver.problem.effort import posture_effort
from tests.solver.methods.synthetic import small_task

PUMA = load_robot("puma560")


def puma_task(norm: str = "l1", turned: float = 0.0) -> ApproachTask:
    """Of an arm whose wrist turns further than once."""
    target = Target("1", (0.4, 0.3, 0.5), (0.2, 1.0, 0.3))
    reference = np.asarray(PUMA.home_joints) + np.array([0, 0, 0, turned, 0, -turned])
    problem = Problem(PUMA, [target], options=Options(norm=norm))  # type: ignore[arg-type]
    return approach_task(problem, target, tuple(reference))


def test_room_for_a_whole_turn_and_a_multiple_of_a_vector() -> None:
    assert 2 * math.pi / 0.03 + 1 <= MOST_SAMPLES
    assert MOST_SAMPLES % 8 == 0
    assert 2 * math.pi / 0.03 + 10 > MOST_SAMPLES


def test_angles_are_spread_evenly_ends_included() -> None:
    scratch = effort_scratch(4)
    spread(scratch, 0.1, 0.7, 4)
    assert scratch.angles[:4] == pytest.approx([0.1, 0.3, 0.5, 0.7])
    assert scratch.angles[3] == 0.7


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize(
    "task",
    [small_task(2, joint_weights=(1, 2, 3, 4, 5, 6)), puma_task(), puma_task(turned=4.0),
     puma_task(turned=-4.0)],
    ids=["tabletop", "puma", "puma turned", "puma turned back"],
)  # fmt: skip
def test_efforts_are_those_of_thinning_postures(task: ApproachTask, norm: str) -> None:
    task = replace(task, options=replace(task.options, norm=norm))  # type: ignore[arg-type]
    rows = len(task.retreats_m)
    scratch, turns = (
        effort_scratch(rows),
        np.empty((TURN_ROWS, effort_scratch(rows).path_turns.shape[1])),
    )
    checked = set()
    for branch in range(8):
        spread(scratch, -0.6, 0.8, 5)
        sample_effort(task.packed(1), scratch, branch, 5)
        for n, angle in enumerate(scratch.angles[:5]):
            path = task.postures(float(angle), 1, branch, np.asarray(task.retreats_m))
            if not np.isfinite(path).all():
                continue
            thinning, joints = path[-1], scratch.joints[:, n]
            apart = np.remainder(joints - thinning + np.pi, 2 * np.pi) - np.pi
            assert apart == pytest.approx(np.zeros(6), abs=1e-7)
            own = posture_effort(joints, task.reference, task.joint_weights, norm)
            assert scratch.efforts[n] == pytest.approx(own, rel=1e-12)
            if np.all(task.inside(path) >= 0.0):
                # On the very turn that the whole cut-in decides.
                assert joints == pytest.approx(thinning, abs=1e-7)
                checked.add(branch)
            turns_along_path(task.packed(1), angle, branch // 2, turns)
            found = np.empty((rows, 6))
            path_joints(task.packed(1), turns, branch % 2, np.empty((6, rows)), found)
            if np.all(task.inside(path) >= 0.0):
                assert found == pytest.approx(path, abs=1e-7)
            assert np.abs(np.diff(found, axis=0)).max() <= np.pi + 1e-9
    assert checked


def test_of_joints_within_one_turn_nothing_else_is_asked(tabletop: Robot) -> None:
    """Cut-ins are not traced for them."""
    task, scratch = small_task(2), effort_scratch(16)
    scratch.path[:] = np.nan
    spread(scratch, 0.1, 0.3, 3)
    sample_effort(task.packed(1), scratch, 2, 3)
    assert np.isnan(scratch.path).all()
    assert np.all(tabletop.upper - tabletop.lower <= 2 * np.pi)
