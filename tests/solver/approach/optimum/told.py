"""Joints that turn with the angle as they are told, in place of an arm's."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.optimum import search
from solver.approach.optimum.effort_samples import MOST_SAMPLES
from solver.approach.task.packed import NUMBERS, REFERENCE, SQUARED, WEIGHTS, PackedTask
from solver.robots.model import Array
from tests.solver.interpreted import interpret

Joints = Callable[[Array], Array]
WEIGHTS_OF = np.array([1.0, 2.0, 0.5, 1.5, 1.0, 3.0])


def task_of(squared: bool = False) -> Any:
    numbers = np.zeros(NUMBERS)
    numbers[REFERENCE : REFERENCE + 6] = 0.1, -0.2, 0.3, 0.0, 0.5, -0.4
    numbers[WEIGHTS : WEIGHTS + 6] = WEIGHTS_OF
    numbers[SQUARED] = squared
    return PackedTask(numbers, np.zeros(2), np.zeros(1))


def cost(task: Any, joints: Array) -> Array:
    travel = joints - task.numbers[REFERENCE : REFERENCE + 6, None]
    parts = travel**2 if task.numbers[SQUARED] else np.abs(travel)
    return np.asarray(WEIGHTS_OF @ parts)


def scratch_of() -> Any:
    return SimpleNamespace(
        angles=np.full(MOST_SAMPLES, np.nan),
        joints=np.full((6, MOST_SAMPLES), np.nan),
        efforts=np.full(MOST_SAMPLES, np.nan),
    )


class Told:
    """Joints as functions of the angle; how many were asked for, and on which branches."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, joints: Joints) -> None:
        self.joints, self.count, self.branches = joints, 0, set[int]()
        interpret(monkeypatch, search, sample_effort=self._sample)

    def _sample(self, task: Any, scratch: Any, branch: int, count: int) -> None:
        self.count += count
        self.branches.add(int(branch))
        angles = scratch.angles[:count]
        assert not np.isnan(angles).any()
        scratch.joints[:, :count] = self.joints(angles)
        scratch.efforts[:count] = cost(task, scratch.joints[:, :count])


def waving(angles: Array) -> Array:
    """Joints that pass their references, some of them twice."""
    x = np.asarray(angles)
    return np.stack(
        (
            0.8 * np.sin(2 * x),
            0.5 * x - 0.2,
            np.cos(3 * x),
            -0.7 * x + 0.1,
            0.4 * x**2,
            0.3 * x - 0.5,
        )
    )


def swinging(angles: Array) -> Array:
    """The fourth turns by half a turn within a hundredth, the sixth against it."""
    x = np.asarray(angles)
    turn = 1.5 * np.tanh((x - 0.31) / 0.004)
    return np.stack((0.2 * x, 0.5 * x - 0.2, 0 * x, turn, 0.4 * x, -turn - 0.4 * x))


def bowl(angles: Array) -> Array:
    """No joint passes its reference: the effort is smooth."""
    x = np.asarray(angles)
    return np.stack(
        (2 + (x - 0.3) ** 2, 2 + 0 * x, 3 + 0.2 * np.cosh(x), 2 + 0 * x, 3 - 0.1 * x, 1 + 0 * x)
    )


MOVES = {"waving": waving, "swinging": swinging, "bowl": bowl}


def dense(task: Any, joints: Joints, low: float, high: float) -> float:
    return float(cost(task, joints(np.linspace(low, high, 400_001))).min())
