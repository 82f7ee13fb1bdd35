"""Samples of all branches, and effort drawn against the approach angle."""

import math

import numpy as np
import pytest

from solver.approach.arcs import arcs
from solver.approach.arcs.arcs import (
    limit_names,
    named_arc,
    sample_angles,
    sample_angles_of,
    sample_task,
    survey_target,
    task_arcs,
)
from solver.approach.arcs.tolerances import ARC_SAMPLES
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.problem.effort import posture_effort
from tests.solver.methods.synthetic import ROBOT, problem_of, small_task


def test_angles_begin_at_half_a_turn_and_are_even() -> None:
    assert sample_angles(4) == pytest.approx([-math.pi, -math.pi / 2, 0.0, math.pi / 2])
    assert sample_angles(1).tolist() == [-math.pi]


def test_efforts_of_samples_are_those_of_thinning() -> None:
    task, angles = small_task(2, symmetric_tool=True), np.array([0.1, 0.3])
    for side in (1, -1):
        margins, efforts = sample_angles_of(task, side, angles)
        assert margins.shape == efforts.shape == (8, 2)
        for branch, k in zip(*(margins >= 0.0).nonzero(), strict=True):
            joints = task.thinning_joints(float(angles[k]), side, int(branch))
            cost = posture_effort(joints, task.reference, task.joint_weights, "l1")
            assert efforts[branch, k] == pytest.approx(cost)
    found, margins, _ = sample_task(task, 1, 5)
    assert found.tolist() == sample_angles(5).tolist()
    assert margins.tolist() == sample_angles_of(task, 1, found)[0].tolist()


def test_a_survey_has_a_curve_for_each_side_and_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(arcs, "ARC_SAMPLES", 90)
    problem = problem_of(symmetric_tool=True)
    target = problem.targets[2]
    survey = survey_target(problem, target, problem.start)
    assert survey.curves == tuple((side, branch) for side in (1, -1) for branch in range(8))
    assert survey.efforts.shape == (16, 90)
    assert survey.angles_rad.tolist() == sample_angles(90).tolist()
    assert ARC_SAMPLES == 90 * 8
    task = small_task(2, symmetric_tool=True)
    assert survey.arcs == task_arcs(task)
    for row, (side, branch) in enumerate(survey.curves):
        own = [a for a in survey.arcs if (a.tool_side, a.branch) == (side, branch)]
        feasible = np.isfinite(survey.efforts[row])
        inside = np.zeros(90, dtype=np.bool_)
        for arc in own:
            away = np.remainder(survey.angles_rad - arc.lower_rad, 2 * np.pi)
            inside |= away <= arc.upper_rad - arc.lower_rad
        assert np.array_equal(feasible, inside)


def test_what_ends_an_arc_has_a_name() -> None:
    names = limit_names(ROBOT)
    assert names[:6] == ROBOT.joint_names
    assert (names[REACH], names[BESIDE], names[JUMP]) == ("reach", "reach", "wrist_jump")
    arc = named_arc(-1, (5.0, 0.1, 0.2, 3.0, -1.0), names)
    assert (arc.tool_side, arc.branch, arc.lower_rad, arc.upper_rad) == (-1, 5, 0.1, 0.2)
    assert (arc.lower_limit, arc.upper_limit) == (ROBOT.joint_names[3], None)
