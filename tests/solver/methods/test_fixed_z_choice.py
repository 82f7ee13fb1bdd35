"""`fixed_z` by hand: its plane, its angle, and what is chosen of branches that are told."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver.approach.task.candidate import Candidate
from solver.approach.task.relaxation import rotation
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.methods import fixed_z
from solver.methods.fixed_z import _angle_forward, _in_the_plane, _swing_back, solve_fixed_z
from solver.problem.solution import Reason
from tests.solver.methods.synthetic import small_task


def leaning(direction: tuple[float, float, float], **options: object) -> ApproachTask:
    task = small_task(method="fixed_z", **options)
    return replace(task, target=replace(task.target, branch_direction=direction))


def test_the_branch_s_part_in_the_plane() -> None:
    flat = _in_the_plane(leaning((0.1, 3.0, -4.0)))
    assert flat.frame.branch == pytest.approx([0.0, 0.6, -0.8])


@pytest.mark.parametrize("angle", [-2.0, 0.0, 1.0, 3.0])
def test_the_angle_of_a_direction(angle: float) -> None:
    task = leaning((0.0, 1.0, 0.5))
    assert _angle_forward(task, task.frame.direction(angle)) == pytest.approx(angle)


def test_a_swing_back_is_the_smallest_rotation() -> None:
    rng = np.random.default_rng(1)
    start, end, vector = rng.normal(size=(3, 3))
    start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
    axis = np.cross(end, start)
    angle = math.atan2(float(np.linalg.norm(axis)), float(end @ start))
    turn = rotation(axis / np.linalg.norm(axis) * angle)
    assert turn @ end == pytest.approx(start)
    assert _swing_back(start, end, vector) == pytest.approx(turn @ vector)


@pytest.mark.parametrize("tolerated", [0.0, 0.1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_branch_may_lean_as_far_as_is_tolerated(tolerated: float, sign: float) -> None:
    """Rounding aside: half of what the verifier allows."""
    for beyond, told in ((-1e-10, False), (1e-4, True)):
        lean = max(tolerated + beyond, 0.0)
        task = leaning((sign * math.sin(lean), 0.0, math.cos(lean)), tilt_tolerance_rad=tolerated)
        answer = solve_fixed_z(task)
        is_told = isinstance(answer, Reason) and answer.code == "method_not_applicable"
        assert is_told == told
        if is_told:
            assert isinstance(answer, Reason)
            tenths = f"{math.degrees(tolerated):.2f} are tolerated"
            assert answer.detail.endswith(tenths)
            assert f"leans {math.degrees(lean):.2f} degrees" in answer.detail


def chosen(
    monkeypatch: pytest.MonkeyPatch,
    offers: dict[tuple[int, int], tuple[float, float]],
    take: int | None = 0,
) -> tuple[Candidate | Reason, list[tuple[float, int, int]]]:
    """Of margin and effort by side and branch; and the places that levels were asked for."""
    places: list[tuple[float, int, int]] = []

    def sampled(task: object, side: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        margins, efforts = np.full((8, 1), -1.0), np.zeros((8, 1))
        for (of, branch), (margin, effort) in offers.items():
            if of == side:
                margins[branch], efforts[branch] = margin, effort
        return margins, efforts

    def first(task: object, every: object) -> int | None:
        places.extend(every)  # type: ignore[arg-type]
        return take if places else None

    monkeypatch.setattr(fixed_z, "sample_angles_of", sampled)
    monkeypatch.setattr(fixed_z, "first_at_level", first)
    monkeypatch.setattr(
        fixed_z, "diagnose", lambda task, angles: Reason("joint_limit", str(angles))
    )
    return solve_fixed_z(leaning((0.0, 1.0, 0.2), symmetric_tool=True)), places


def test_the_cheapest_that_is_feasible_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """A margin of nothing is one; ties go to the first side, then to the lower branch."""
    offers = {
        (1, 3): (0.0, 2.0), (1, 1): (0.1, 2.0), (-1, 0): (0.2, 2.0), (-1, 5): (0.0, 1.0),
        (1, 7): (-1e-9, 0.5),
    }  # fmt: skip
    answer, places = chosen(monkeypatch, offers)
    assert [place[1:] for place in places] == [(-1, 5), (1, 1), (1, 3), (-1, 0)]
    assert isinstance(answer, Candidate)
    assert (answer.tool_side, answer.branch, answer.effort) == (-1, 5, 1.0)
    assert (answer.iterations, answer.status) == (1, "along_world_x")
    second, _ = chosen(monkeypatch, offers, take=2)
    assert isinstance(second, Candidate)
    assert (second.tool_side, second.branch, second.effort) == (1, 3, 2.0)


def test_where_none_is_feasible_there_is_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(chosen(monkeypatch, {(1, 3): (-0.1, 2.0)})[0], Reason)


@pytest.mark.parametrize("lean", [0.0, 0.15, -0.15])
def test_the_forks_point_along_x_and_the_angle_is_that_before_the_swing(lean: float) -> None:
    direction = (math.sin(lean), math.cos(lean), 0.0)
    task = leaning(direction, tilt_tolerance_rad=0.2)
    task = replace(task, target=replace(task.target, position_m=(0.23, 0.05, 0.35)))
    answer = solve_fixed_z(task)
    assert isinstance(answer, Candidate)
    pose = forward_kinematics(task.robot, task.tool, np.asarray(answer.thinning_joints))
    assert pose[:3, 2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert pose[:3, 1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    swing = rotation(np.array([0.0, 0.0, lean]))
    upright = swing.T @ pose[:3, 2]
    assert task.frame.direction(answer.approach_angle_rad) == pytest.approx(upright, abs=1e-9)
