"""The best over a rail's positions, of answers that are told."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.kinematics.families.on_rail import split_rail
from solver.methods import any_arm
from solver.methods.any_arm import not_applicable, on_any_arm, over_rail
from solver.methods.rail import rail_effort, rail_positions
from solver.problem.solution import Reason
from tests.solver.kinematics.arms import ur5
from tests.solver.methods.on_rail import TARGETS, task_of
from tests.solver.methods.synthetic import small_task

TASK = task_of(TARGETS[0])
_FOUND = split_rail(TASK.robot)
assert _FOUND is not None
RAIL: Rail = _FOUND
PLACES = [float(place) for place in rail_positions(TASK)]


def outcome(effort: float, iterations: int = 1) -> Candidate:
    return Candidate(0.1, 1, 3, (0.0,) * 6, effort, iterations, "told")


def run(answer: Callable[[int], Candidate | Reason]) -> tuple[Candidate | Reason, list[float]]:
    """With the answer of every position by its number, and the positions asked."""
    asked: list[float] = []

    def solve(task: ApproachTask) -> Candidate | Reason:
        # Where the arm stands is where the slide is.
        moved = sum(
            (here - there) * along
            for here, there, along in zip(
                task.robot.mount_position_m, RAIL.arm.mount_position_m, RAIL.axis, strict=True
            )
        )
        asked.append(moved)
        return answer(len(asked) - 1)

    return over_rail(TASK, RAIL, solve), asked


def test_travel_counts_and_efforts_are_the_sum() -> None:
    efforts = {0: 5.0, 3: 1.0, 4: 0.9}
    found, asked = run(lambda k: outcome(efforts.get(k, 8.0), 10 + k))
    assert isinstance(found, Candidate)
    totals = {k: effort + rail_effort(TASK, PLACES[k]) for k, effort in efforts.items()}
    k = min(totals, key=lambda one: totals[one])
    assert found.effort == pytest.approx(totals[k])
    assert found.thinning_joints == (PLACES[k], *(0.0,) * 6)
    assert asked == pytest.approx(PLACES[: len(asked)])
    assert found.iterations == sum(10 + k for k in range(len(asked)))


def test_it_ends_where_travel_alone_is_too_dear() -> None:
    _, asked = run(lambda k: outcome(0.2))
    assert len(asked) == sum(rail_effort(TASK, place) < 0.2 for place in PLACES)
    assert 1 < len(asked) < len(PLACES)
    assert len(run(lambda k: outcome(0.0))[1]) == 1


def test_ties_go_to_the_position_that_is_nearer() -> None:
    far = rail_effort(TASK, PLACES[4])
    found, _ = run(lambda k: outcome(1.0 + far - rail_effort(TASK, PLACES[k])))
    assert isinstance(found, Candidate)
    assert found.thinning_joints[0] in PLACES[:5]
    assert found.effort == pytest.approx(1.0 + far)
    equal, _ = run(lambda k: replace(outcome(1.0), effort=1.0 - rail_effort(TASK, PLACES[k])))
    assert isinstance(equal, Candidate)
    assert equal.thinning_joints[0] == PLACES[0]


def test_positions_without_an_approach_are_passed_over() -> None:
    found, asked = run(lambda k: outcome(2.0, 7) if k == 5 else Reason("joint_limit", "no"))
    assert isinstance(found, Candidate)
    assert found.thinning_joints[0] == PLACES[5]
    assert found.iterations == 7
    assert len(asked) > 6


@pytest.mark.parametrize(
    ("furthest", "others"),
    [
        (Reason("joint_limit", "x", margin_rad=-0.5), Reason("out_of_reach", "y", margin_m=-0.1)),
        (Reason("standby_infeasible", "x"), Reason("joint_limit", "y", margin_rad=-0.1)),
        (Reason("cut_in_infeasible", "x"), Reason("standby_infeasible", "y")),
        (Reason("out_of_reach", "x", margin_m=-0.1), Reason("wrist_jump", "y")),
        (Reason("out_of_reach", "x", margin_m=-0.1), Reason("out_of_reach", "y", margin_m=-0.2)),
        (Reason("joint_limit", "x", margin_rad=-0.1), Reason("joint_limit", "y", margin_rad=-0.2)),
        (Reason("joint_limit", "x", margin_rad=0.25), Reason("joint_limit", "y")),
        (
            Reason("joint_limit", "x", margin_rad=-0.3, margin_m=0.2),
            Reason("joint_limit", "y", margin_rad=0.1, margin_m=-0.2),
        ),
        (Reason("joint_limit", "x"), Reason("joint_limit", "y", margin_rad=-0.1)),
    ],
)
def test_the_furthest_that_a_target_came_is_the_reason(furthest: Reason, others: Reason) -> None:
    found, asked = run(lambda k: furthest if k == 4 else others)
    assert isinstance(found, Reason)
    assert found == replace(furthest, detail="at every position of the rail; at the best one x")
    assert len(asked) == len(PLACES)


def test_an_arm_with_a_closed_form_is_solved_as_it_is() -> None:
    task = small_task()
    assert on_any_arm(lambda given: outcome(1.0) if given is task else not_applicable(task))(
        task
    ) == outcome(1.0)


def test_an_arm_on_a_rail_is_solved_over_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(any_arm, "over_rail", lambda task, rail, solve: (task, rail, solve))
    given: Any = on_any_arm(not_applicable)(TASK)
    assert given == (TASK, RAIL, not_applicable)


def test_an_arm_with_neither_is_told_so() -> None:
    task = replace(small_task(method="as"), robot=ur5(), tool=ur5().tools[0])
    reason = on_any_arm(lambda _: outcome(1.0))(task)
    assert reason == not_applicable(task)
    assert isinstance(reason, Reason)
    assert reason.code == "method_not_applicable"
    assert reason.detail.startswith("as needs the closed form of a spherical wrist, which ")
    assert ur5().name in reason.detail
