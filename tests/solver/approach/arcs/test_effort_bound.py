"""What effort is at least in a cell is below what it is anywhere in it."""

import math

import numpy as np
import pytest

from solver import Options, Problem
from solver.approach.arcs.effort_bound import effort_at_least, write_reference
from solver.approach.arcs.turns import TURN_ROWS, joints_of_turns, turns_at_angles
from solver.approach.task.packed import PackedTask, jump_cosines
from solver.approach.task.packing import packed_targets
from solver.problem.options import Norm
from solver.problem.retreats import looked_at_retreats
from solver.robots.files import load_robot
from solver.tolerances import EFFORT_ERROR_RELATIVE
from tests.solver.problems import random_targets

INSIDE = 40
"""Angles looked at in a cell."""


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("width", [math.radians(5.0), math.radians(1.0)])
def test_no_effort_in_a_cell_is_below_its_bound(norm: Norm, width: float) -> None:
    rng = np.random.default_rng(16)
    problem = Problem(load_robot("tabletop"), random_targets(3, 60), Options(norm=norm))
    positions = np.array([target.position_m for target in problem.targets])
    directions = np.array([target.branch_direction for target in problem.targets])
    retreats = looked_at_retreats(problem.options)
    numbers = packed_targets(problem, positions, directions, np.asarray(problem.start))[0]
    tight = looked = 0
    for own in numbers:
        task = PackedTask(own, retreats, jump_cosines(retreats))
        reference = np.empty((6, 2))
        write_reference(task, reference)
        for arm in range(4):
            low = rng.uniform(-math.pi, math.pi)
            ends = np.array([low - width, low, low + width, low + 2 * width])
            around = np.empty((TURN_ROWS, 8))
            turns_at_angles(task, ends, 4, 0.0, arm, around)
            angles = np.linspace(low, low + width, INSIDE)
            turns, joints = np.empty((TURN_ROWS, INSIDE)), np.empty((6, INSIDE))
            turns_at_angles(task, angles, INSIDE, 0.0, arm, turns)
            reached = (turns[12] >= 0) & (turns[13] >= 0)
            if not reached.any():
                continue
            for wrist in range(2):
                joints_of_turns(task, turns, INSIDE, wrist, joints)
                travel = joints[:, reached] - np.asarray(problem.start)[:, None]
                travel = np.abs(np.remainder(travel + np.pi, 2 * np.pi) - np.pi)
                cost = travel if norm == "l1" else travel**2
                least = (np.asarray(problem.joint_weights) @ cost).min()
                bound = effort_at_least(
                    task, reference, wrist, around, 0, around, 1, around, 2, around, 3
                )
                assert bound <= least * (1 + EFFORT_ERROR_RELATIVE)
                looked += 1
                tight += bool(bound > 0.9 * least)
    assert looked > 100
    # A bound that says little is of no use.
    assert tight > 0.8 * looked
