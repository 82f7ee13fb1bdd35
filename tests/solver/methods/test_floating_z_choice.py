"""What `floating_z` chooses of samples that are told."""

import math

import numpy as np
import pytest

from solver.approach.task.candidate import Candidate
from solver.methods import floating_z
from solver.methods.floating_z import solve_floating_z
from solver.problem.solution import Reason
from tests.solver.methods.synthetic import small_task

Place = tuple[float, int, int]


def chosen(
    monkeypatch: pytest.MonkeyPatch,
    offers: dict[tuple[int, int, int], tuple[float, float]],
    take: int = 0,
    phase: float = 0.0,
) -> tuple[Candidate | Reason, list[Place], list[np.ndarray]]:
    """Of margin and effort by side, branch and sample; the places offered, and the angles."""
    places: list[Place] = []
    asked: list[np.ndarray] = []

    def sampled(task: object, side: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        asked.append(angles)
        margins, efforts = np.full((8, 8), -1.0), np.zeros((8, 8))
        for (of, branch, k), (margin, effort) in offers.items():
            if of == side:
                margins[branch, k], efforts[branch, k] = margin, effort
        return margins, efforts

    def first(task: object, every: object) -> int | None:
        places.extend(every)  # type: ignore[arg-type]
        return take if places else None

    monkeypatch.setattr(floating_z, "sample_angles_of", sampled)
    monkeypatch.setattr(floating_z, "first_at_level", first)
    monkeypatch.setattr(
        floating_z, "diagnose", lambda task, angles: Reason("joint_limit", f"of {len(angles)}")
    )
    task = small_task(samples=8, symmetric_tool=True, method="floating_z")
    return solve_floating_z(task, phase), places, asked


def test_the_cheapest_first_then_the_smaller_angle_the_first_side_and_the_lower_branch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    offers = {
        (1, 6, 1): (0.0, 2.0), (1, 2, 4): (0.1, 3.0), (-1, 1, 4): (0.1, 3.0),
        (1, 1, 4): (0.0, 3.0), (1, 0, 5): (0.2, 3.0), (1, 0, 0): (-1e-12, 0.1),
        (-1, 3, 3): (0.2, 3.0),
    }  # fmt: skip
    answer, places, asked = chosen(monkeypatch, offers)
    quarter = math.pi / 4
    expected = [
        (-3 * quarter, 1, 6), (0.0, 1, 1), (0.0, 1, 2), (0.0, -1, 1), (quarter, 1, 0),
        (-quarter, -1, 3),
    ]  # fmt: skip
    assert [place[1:] for place in places] == [place[1:] for place in expected]
    assert [place[0] for place in places] == pytest.approx([place[0] for place in expected])
    assert isinstance(answer, Candidate)
    assert (answer.tool_side, answer.branch, answer.effort) == (1, 6, 2.0)
    assert (answer.iterations, answer.status) == (8, "best_of_samples")
    assert len(asked) == 2
    assert asked[0] == pytest.approx(-math.pi + quarter * np.arange(8))
    fourth, _, _ = chosen(monkeypatch, offers, take=3)
    assert isinstance(fourth, Candidate)
    assert (fourth.tool_side, fourth.branch, fourth.approach_angle_rad) == (-1, 1, 0.0)
    joints = small_task(symmetric_tool=True).thinning_joints(0.0, -1, 1)
    assert fourth.thinning_joints == pytest.approx(joints)


def test_a_phase_turns_all_angles(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, _, asked = chosen(monkeypatch, {(1, 2, 7): (0.1, 1.0)}, phase=1.0)
    assert asked[0] == pytest.approx(1.0 - math.pi + math.pi / 4 * np.arange(8))
    assert isinstance(answer, Candidate)
    assert answer.approach_angle_rad == pytest.approx(1.0 + 0.75 * math.pi - 2 * math.pi)


def test_without_a_feasible_sample_there_is_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, _, _ = chosen(monkeypatch, {(1, 2, 7): (-0.1, 1.0)})
    assert answer == Reason("joint_limit", "of 8")
