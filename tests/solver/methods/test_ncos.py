import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solver import Options, Problem, Robot, solve, verify_plan
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.candidate import Candidate
from solver.approach.task.relaxation import placement
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.forward import forward_kinematics
from solver.methods.coupling import Coupling
from solver.methods.ncos import improved, solve_ncos, solve_on_arc
from solver.methods.nlp import ipopt, sqp
from solver.methods.nlp.backends import BACKENDS
from solver.methods.nlp.quadratic import QP_SOLVERS
from solver.methods.relaxed.approach import between_neighbours
from solver.methods.semi_analytic import solve_ssas
from solver.problem.effort import posture_effort
from solver.problem.options import QpSolverName
from solver.tolerances import LIMIT_EXCESS_RAD
from tests.solver.problems import data_set_3, random_targets

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": math.radians(10)}


def tasks(robot: Robot, seed: int, count: int, **options: object) -> list[ApproachTask]:
    """The first `count` tasks of seeded random targets that have an unrelaxed approach."""
    targets = random_targets(seed=seed, count=8 * count)
    problem = Problem(robot, targets, options=Options(**options))  # type: ignore[arg-type]
    every = (approach_task(problem, target, problem.start) for target in targets)
    found = list(islice((task for task in every if best_on_arcs(task) is not None), count))
    assert len(found) == count
    return found


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_never_worse_than_its_warm_start_and_equal_to_1e_6(
    tabletop: Robot, norm: str, backend: str
) -> None:
    solved = 0
    for task in tasks(tabletop, 21, 30, norm=norm, nlp_backend=backend):
        warm_start, answer = solve_ssas(task), solve_ncos(task)
        assert isinstance(warm_start, Candidate)
        assert isinstance(answer, Candidate)
        assert answer.effort <= effort_of(task, warm_start.thinning_joints)
        assert answer.effort == pytest.approx(warm_start.effort, rel=1e-6)
        solved += answer.status.startswith("solved")
    assert solved == 30


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_the_programme_finds_its_own_way_from_a_bad_start(
    tabletop: Robot, backend: str, norm: str
) -> None:
    """It is an optimisation: started at the far end of the arc it comes to the same angle."""
    problem = data_set_3(tabletop, norm=norm, nlp_backend=backend)
    task = approach_task(problem, problem.targets[0], problem.start)
    best = best_on_arcs(task)
    assert best is not None
    start = replace(best, angle_rad=0.9 * best.arc.lower_rad + 0.1 * best.angle_rad)
    assert abs(start.angle_rad - best.angle_rad) > 0.3
    result = solve_on_arc(task, start)
    assert result.success
    assert result.x[12] == pytest.approx(best.angle_rad, abs=1e-5)
    assert 0 < result.iterations < 50


@pytest.mark.parametrize("qp_solver", QP_SOLVERS)
@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_solvers_of_quadratic_programmes_agree(
    tabletop: Robot, qp_solver: QpSolverName, norm: str
) -> None:
    for task in tasks(tabletop, 22, 8, norm=norm, qp_solver=qp_solver):
        best = best_on_arcs(task)
        assert best is not None
        beside = (3 * best.angle_rad + (best.arc.lower_rad + best.arc.upper_rad) / 2) / 4
        answers = []
        for name in (qp_solver, "daqp"):
            chosen = replace(task, options=replace(task.options, qp_solver=name))
            result = solve_on_arc(chosen, replace(best, angle_rad=beside))
            assert result.success, (name, result.status)
            arc = best.arc
            thinning = task.thinning_joints(float(result.x[12]), arc.tool_side, arc.branch)
            answers.append(effort_of(task, thinning))
        assert answers[0] == pytest.approx(answers[1], rel=1e-6)


def effort_of(task: ApproachTask, thinning: Sequence[float]) -> float:
    return posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)


@pytest.mark.parametrize(
    ("backend", "status"),
    [("sqp", "iteration_limit"), ("ipopt", "Maximum_Iterations_Exceeded")],
)
def test_a_failed_programme_returns_the_warm_start_and_says_so(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch, backend: str, status: str
) -> None:
    monkeypatch.setattr(ipopt, "NLP_ITERATIONS", 0)
    monkeypatch.setattr(sqp, "SQP_ITERATIONS", 0)
    plan = solve(data_set_3(tabletop, nlp_backend=backend))
    ssas = solve(data_set_3(tabletop, method="ssas"))
    assert plan.planned == 5
    for approach, expected in zip(plan.approaches, ssas.approaches, strict=True):
        assert approach.solver.status == f"warm_start_after_{status}"
        assert approach.effort == pytest.approx(expected.effort, rel=1e-12)


def test_a_failed_relaxed_programme_returns_what_it_started_from_and_says_so(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqp, "SQP_ITERATIONS", 0)
    plan = solve(data_set_3(tabletop, order="independent", **RELAXED))
    ssas = solve(data_set_3(tabletop, method="ssas", order="independent"))
    assert plan.planned == 5
    for approach, expected in zip(plan.approaches, ssas.approaches, strict=True):
        assert approach.solver.status == "warm_start_after_iteration_limit"
        assert approach.effort is not None
        assert expected.effort is not None
        assert approach.effort <= expected.effort


@pytest.mark.parametrize(
    "options",
    [
        {"strike_zone_m": 0.02},
        {"tilt_tolerance_rad": math.radians(10), "nlp_backend": "ipopt"},
        {**RELAXED, "norm": "l2"},
        {**RELAXED, "symmetric_tool": True},
        {"tilt_tolerance_rad": 1e-3},
    ],
    ids=["strike", "tilt ipopt", "both l2", "both symmetric", "little tilt"],
)
def test_relaxed_is_never_dearer_and_stays_inside(
    tabletop: Robot, options: dict[str, object]
) -> None:
    cheaper = 0
    for task in tasks(tabletop, 23, 10, position_margin_m=0.0, **options):
        unrelaxed, relaxed = solve_ssas(task), solve_ncos(task)
        assert isinstance(unrelaxed, Candidate)
        assert isinstance(relaxed, Candidate)
        thinning = np.asarray(relaxed.thinning_joints)
        seen = placement(
            task.frame,
            np.asarray(task.target.position_m),
            relaxed.tool_side,
            forward_kinematics(task.robot, task.tool, thinning),
        )
        assert -1e-9 <= seen.strike_m <= task.options.strike_zone_m + 1e-9
        assert seen.tilt_rad <= task.options.tilt_tolerance_rad + 1e-9
        retreats = np.asarray(task.retreats_m)
        rows = retreat_rows(
            task.robot, task.tool, relaxed.thinning_joints, relaxed.branch, retreats
        )
        inside = np.minimum(rows - task.lower, task.upper - rows).min()
        assert inside >= -LIMIT_EXCESS_RAD
        assert relaxed.effort == effort_of(task, relaxed.thinning_joints)
        assert relaxed.effort <= effort_of(task, unrelaxed.thinning_joints) * (1 + 1e-12)
        cheaper += relaxed.effort < unrelaxed.effort * (1 - 1e-6)
    assert cheaper >= 5


def test_backends_agree_on_relaxed_tasks(tabletop: Robot) -> None:
    """Different paths from the same starts; with a few of them nearly always the same optimum."""
    efforts = {}
    for backend in BACKENDS:
        answers = [
            solve_ncos(task) for task in tasks(tabletop, 24, 10, nlp_backend=backend, **RELAXED)
        ]
        efforts[backend] = [a.effort for a in answers if isinstance(a, Candidate)]
    same = np.isclose(efforts["sqp"], efforts["ipopt"], rtol=1e-6)
    assert len(same) == 10
    assert same.sum() >= 8


def test_relaxations_rescue_targets_and_the_rescued_verify(tabletop: Robot) -> None:
    targets = random_targets(seed=3, count=30)
    options = Options(order="independent", method="ssas")
    before = solve(Problem(tabletop, targets, options=options))
    refused = [a.target_id for a in before.approaches if a.status != "planned"]
    left = [target for target in targets if target.id in refused]
    options = Options(order="independent", **RELAXED)  # type: ignore[arg-type]
    after = solve(Problem(tabletop, left, options=options))
    assert after.planned >= 1
    results = verify_plan(after)
    assert len(results) == after.planned
    assert all(verification.accepted for verification in results.values())
    for approach in after.approaches:
        if approach.status == "planned":
            assert approach.strike_m is not None
            assert approach.tilt_rad is not None
            assert max(approach.strike_m, approach.tilt_rad) > 1e-3
        else:
            assert approach.reason is not None
            assert "relaxations" in approach.reason.detail
            assert approach.reason.code != "solver_failed"


def test_the_next_target_is_looked_ahead_to(tabletop: Robot) -> None:
    """The coupled cost is that of thinning and of the travel onwards, and is never dearer."""
    for options in ({}, {"norm": "l2"}, RELAXED):
        changed = 0
        for task in tasks(tabletop, 26, 6, position_margin_m=0.0, **options):
            alone, warm_start = solve_ncos(task), best_on_arcs(task)
            assert isinstance(alone, Candidate)
            assert warm_start is not None
            following = tuple(np.asarray(task.robot.home_joints) + 0.4)
            coupling = Coupling(task, following)
            if task.options.relaxed:
                coupled = between_neighbours(task, alone, coupling)
            else:
                coupled = improved(task, warm_start, following)
            costs = [coupling.cost(answer) for answer in (alone, coupled)]
            assert costs[1] <= costs[0] * (1 + 1e-9)
            assert coupled.effort >= alone.effort * (1 - 1e-9) or options is RELAXED
            changed += costs[1] < costs[0] * (1 - 1e-6)
        assert changed >= 3


def test_same_task_same_answer(tabletop: Robot) -> None:
    for backend in BACKENDS:
        first, second = (
            [solve_ncos(task) for task in tasks(tabletop, 27, 4, nlp_backend=backend, **RELAXED)]
            for _ in range(2)
        )
        assert first == second


@pytest.mark.parametrize("value", [5e-324, 1e-300, 1e-160, 1e-12])
@pytest.mark.parametrize("name", ["strike_zone_m", "tilt_tolerance_rad"])
def test_a_relaxation_that_underflows_is_none(tabletop: Robot, name: str, value: float) -> None:
    options = {"method": "ncos", "order": "independent"}
    plain = solve(data_set_3(tabletop, **options))
    tiny = solve(data_set_3(tabletop, **options, **{name: value}))
    assert tiny.planned == plain.planned == 5
    for one, two in zip(plain.approaches, tiny.approaches, strict=True):
        assert one.effort == two.effort
