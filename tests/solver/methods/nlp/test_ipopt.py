"""IPOPT: what it is told, seen on programmes of one variable, and errors as a status."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import Instance, make_instance, shape_of
from solver.methods.nlp.ipopt import ipopt_options, solve_by_ipopt
from solver.methods.nlp.sqp import solve_by_sqp
from solver.methods.nlp.starts import start_at
from tests.solver.methods.synthetic import ROBOT, small_task


def solver(iterations: int = 50, barrier: float = 1e-4) -> Any:
    x = ca.SX.sym("x")
    nlp = {"x": x, "f": (x - 2) ** 2, "g": ca.SX(0, 1)}
    options = ipopt_options(tolerance=1e-9, barrier=barrier, iterations=iterations)
    return ca.nlpsol("toy", "ipopt", nlp, options)


def test_it_says_nothing_and_keeps_its_bounds(capfd: pytest.CaptureFixture[str]) -> None:
    answer = solver()(x0=0.3, lbx=0.0, ubx=1.0)
    assert float(answer["x"]) == pytest.approx(1.0, abs=1e-6)
    assert float(answer["x"]) <= 1.0
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("start", [0.0, 0.5, 1.0])
def test_a_start_near_its_bounds_is_hardly_moved(start: float) -> None:
    none = solver(iterations=0)
    assert float(none(x0=start, lbx=0.0, ubx=1.0)["x"]) == pytest.approx(start, abs=2e-5)
    assert not none.stats()["success"]


def instance_of(**options: object) -> Instance:
    task = small_task(0, **options)
    start = start_at(task, 1, 2, np.asarray(task.thinning_joints(0.2, 1, 2)))
    return make_instance(task, build_programme(ROBOT, shape_of(task)), start)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_both_methods_end_at_the_same_minimum(norm: str) -> None:
    instance = instance_of(norm=norm)
    first, second = solve_by_ipopt(ROBOT, instance), solve_by_sqp(ROBOT, instance, "daqp")
    assert (first.success, first.status) == (True, "Solve_Succeeded")
    assert 0 < first.iterations < 60
    assert second.success
    assert first.x[:13] == pytest.approx(second.x[:13], abs=1e-5)
    assert np.all(first.x >= instance.lower)
    assert np.all(first.x <= instance.upper)


def test_what_it_cannot_begin_with_is_a_status() -> None:
    instance = instance_of()
    broken = replace(instance, x0=np.zeros(3))
    result = solve_by_ipopt(ROBOT, broken)
    assert (result.success, result.iterations) == (False, 0)
    assert result.status.startswith("error: ")
    assert "\n" not in result.status
    assert result.x is broken.x0
