"""Feasible arcs against dense sweeps of the exact margin."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from solver import Options, Problem, Robot, Target
from solver.approach.arcs.arcs import sample_angles_of, task_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.problem.solution import Arc
from solver.robots.model import Array
from tests.solver.approach.targets import (
    near_limits,
    near_straight_wrists,
    near_the_edge_of_reach,
    over_the_waist,
)
from tests.solver.kinematics.arms import arms
from tests.solver.problems import in_front_of, random_targets

ANGLES = 2048
CLEAR = 1e-9
"""Margin from which a sampled angle has to be in an arc; below minus it, it must not be [rad]."""


def inside(arcs: tuple[Arc, ...], side: int, branch: int, angles: Array) -> NDArray[np.bool_]:
    """Whether each angle is in an arc of the branch, ends included."""
    found = np.zeros(len(angles), dtype=np.bool_)
    for arc in arcs:
        if (arc.tool_side, arc.branch) == (side, branch):
            beyond = np.remainder(angles - arc.lower_rad + CLEAR, 2 * np.pi)
            found |= beyond <= arc.upper_rad - arc.lower_rad + 2 * CLEAR
    return found


def assert_arcs_are_the_feasible_angles(task: ApproachTask) -> int:
    """No sampled angle is missed or claimed; returns how many arcs there are."""
    arcs = task_arcs(task)
    angles = -np.pi + 2 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    for side in task.tool_sides:
        margins, _ = sample_angles_of(task, side, angles)
        for branch in range(8):
            claimed = inside(arcs, side, branch, angles)
            assert not np.any(~claimed & (margins[branch] >= CLEAR)), "missed"
            assert not np.any(claimed & (margins[branch] < -CLEAR)), "claimed"
    return len(arcs)


OPTIONS = {
    "plain": Options(),
    "long standoff": Options(standoff_m=0.12),
    "short standoff, two rows": Options(standoff_m=0.01, path_points=2),
    "many rows": Options(path_points=60),
    "no margin": Options(limit_margin_rad=0.0),
    "wide margin": Options(limit_margin_rad=0.2),
    "symmetric tool": Options(symmetric_tool=True),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_no_angle_is_missed_or_claimed(tabletop: Robot, name: str) -> None:
    problem = Problem(tabletop, random_targets(41, 30), options=OPTIONS[name])
    counts = [
        assert_arcs_are_the_feasible_angles(approach_task(problem, target, problem.start))
        for target in problem.targets
    ]
    assert sum(counts) >= 15


@pytest.mark.parametrize(
    "made", [near_limits, near_straight_wrists, near_the_edge_of_reach, over_the_waist]
)
def test_hard_targets(tabletop: Robot, made: Callable[[Robot, int], list[Target]]) -> None:
    problem = Problem(tabletop, made(tabletop, 15))
    for target in problem.targets:
        assert_arcs_are_the_feasible_angles(approach_task(problem, target, problem.start))


@pytest.mark.parametrize("arm", arms()[2::4], ids=lambda arm: arm.name)
def test_arms_with_offsets(arm: Robot) -> None:
    scale = 2.0 if arm.name == "puma560" else 1.0
    targets = [
        replace(one, position_m=tuple(scale * x for x in one.position_m))
        for one in random_targets(42, 12)
    ]
    problem = Problem(arm, in_front_of(arm, targets))
    counts = [
        assert_arcs_are_the_feasible_angles(approach_task(problem, target, problem.start))
        for target in problem.targets
    ]
    assert sum(counts) > 0


def test_an_arc_ends_where_its_limit_says(tabletop: Robot) -> None:
    """A hair beyond an end the named joint is the one outside; a hair inside all are in."""
    problem = Problem(tabletop, random_targets(43, 40))
    names, seen = tabletop.joint_names, set()
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        for arc in task_arcs(task):
            ends = ((arc.lower_rad, 1e-7, arc.lower_limit), (arc.upper_rad, -1e-7, arc.upper_limit))
            for end, inwards, limit in ends:
                assert limit is not None
                if limit not in names or arc.upper_rad - arc.lower_rad < 1e-6:
                    continue
                joint = names.index(limit)
                retreats = np.asarray(task.retreats_m)
                for step, wanted in ((inwards, True), (-inwards, False)):
                    rows = task.postures(end + step, arc.tool_side, arc.branch, retreats)
                    within = (task.lower <= rows) & (rows <= task.upper)
                    assert within[:, joint].all() == wanted
                    seen.add(limit)
    assert len(seen) >= 3
