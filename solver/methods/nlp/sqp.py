"""A sequential quadratic programme on CasADi's exact derivatives, in the space of the free motions.

Each iteration factorises the Jacobian of the equations, J' = Q R, Q = [Y Z]. A step is
d = Y p + Z u: p solves the linearised equations, and u moves along them, which for an unrelaxed
task is the approach angle alone. So the quadratic programme has a handful of variables, and only
Z' H Z, the reduced Hessian of the Lagrangian, has to be made positive definite.

A step is taken when the exact merit function cost + mu |equations| falls enough (Armijo), with
second-order corrections before it is halved. mu is above every multiplier, so that a step never
trades feasibility for cost; bounds and inequalities hold at every point. Where limits forbid to
solve the linearised equations, a step only repairs. Source: Nocedal and Wright, Numerical
Optimization, 2006, algorithm 18.3 and section 18.3.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from solver.methods.nlp.formulation import Shape, build_programme
from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.nlp.quadratic import QuadraticAnswer, solve_quadratic
from solver.methods.nlp.tolerances import (
    NLP_TOLERANCE,
    SQP_CORRECTIONS,
    SQP_CURVATURE,
    SQP_DAMPING,
    SQP_DECREASE,
    SQP_HALVINGS,
    SQP_ITERATIONS,
    SQP_LONGEST_STEP,
    SQP_PENALTY,
    SQP_RANK,
    SQP_ROUNDING,
    SQP_SLACK_CURVATURE,
    SQP_STEP,
)
from solver.robots.model import Array, Robot


@dataclass(frozen=True)
class _Functions:
    values: Any
    derivatives: Any


@lru_cache(maxsize=64)
def _functions(robot: Robot, shape: Shape) -> _Functions:
    """Cost and constraints of a programme, and their derivatives, built once in a process."""
    nlp = build_programme(robot, shape).nlp
    x, p, f, g = nlp["x"], nlp["p"], nlp["f"], nlp["g"]
    multipliers = ca.SX.sym("lambda", g.numel())
    hessian, _ = ca.hessian(f + ca.dot(multipliers, g), x)
    dense = [ca.densify(part) for part in (ca.gradient(f, x), ca.jacobian(g, x), hessian)]
    return _Functions(
        ca.Function("values", [x, p], [f, g]),
        ca.Function("derivatives", [x, p, multipliers], dense),
    )


class _Evaluator:
    """The functions of one solve, on buffers of its own so that no two solves share any."""

    def __init__(self, functions: _Functions, instance: Instance) -> None:
        count, size = len(instance.x0), instance.programme
        constraints = size.equalities + size.inequalities
        self._x, self._multipliers = np.zeros(count), np.zeros(constraints)
        self._parameters = instance.parameters.copy()
        self._cost, self._constraints = np.zeros(1), np.zeros(constraints)
        self._gradient = np.zeros(count)
        self._jacobian = np.zeros((constraints, count), order="F")
        self._hessian = np.zeros((count, count), order="F")
        self._keep: list[Any] = []
        self._values = self._bind(
            functions.values, (self._x, self._parameters), (self._cost, self._constraints)
        )
        self._derivatives = self._bind(
            functions.derivatives,
            (self._x, self._parameters, self._multipliers),
            (self._gradient, self._jacobian, self._hessian),
        )

    def _bind(self, function: Any, arguments: tuple[Array, ...], results: tuple[Array, ...]) -> Any:
        buffer, trigger = function.buffer()
        for k, array in enumerate(arguments):
            buffer.set_arg(k, array.data)
        for k, array in enumerate(results):
            buffer.set_res(k, array.ravel(order="K").data)
        self._keep.append(buffer)
        return trigger

    def values(self, x: Array) -> tuple[float, Array]:
        """Cost and constraints."""
        self._x[:] = x
        self._values()
        return float(self._cost[0]), self._constraints.copy()

    def derivatives(self, x: Array, multipliers: Array) -> tuple[Array, Array, Array]:
        """Gradient, Jacobian of the constraints, Hessian of the Lagrangian; valid until the next.

        The Lagrangian is cost + multipliers' constraints.
        """
        self._x[:], self._multipliers[:] = x, multipliers
        self._derivatives()
        return self._gradient, self._jacobian, self._hessian


@dataclass
class _Equations:
    """The equations' Jacobian, factorised."""

    y: Array
    z: Array
    r: Array

    def shortest(self, residual: Array) -> Array:
        """The shortest step that solves the linearised equations."""
        return np.asarray(-self.y @ np.linalg.solve(self.r.T, residual))

    def multipliers(self, gradient: Array) -> Array:
        """Multipliers with which the equations balance a gradient."""
        return np.asarray(-np.linalg.solve(self.r, self.y.T @ gradient))


@dataclass(frozen=True)
class _Point:
    x: Array
    cost: float
    constraints: Array
    violation: float


class _Search:
    """One solve: the state that its iterations change."""

    def __init__(self, robot: Robot, instance: Instance, qp_solver: str) -> None:
        programme = instance.programme
        self.instance, self.qp_solver = instance, qp_solver
        self.equalities, self.kinematic = programme.equalities, programme.kinematic
        self.evaluator = _Evaluator(_functions(robot, programme.shape), instance)
        self.multipliers = np.zeros(programme.equalities + programme.inequalities)
        self.price = 0.0
        self.point = self._at(instance.x0)

    def _at(self, x: Array) -> _Point:
        cost, constraints = self.evaluator.values(x)
        # Inequalities hold at every point: `Instance.inside` sees to it.
        violation = float(np.linalg.norm(constraints[: self.equalities]))
        return _Point(x, cost, constraints, violation)

    def iterate(self) -> str | None:
        """One iteration; a status when it was the last."""
        here, k = self.point, self.kinematic
        if not self.multipliers.any():
            self._guess_multipliers()
        gradient, jacobian, hessian = self.evaluator.derivatives(here.x, self.multipliers)
        equations = _factorised(jacobian[: self.equalities, :k])
        if equations is None:
            return "singular"
        step, answer = self._step(equations, gradient, jacobian, hessian)
        feasible = here.violation <= NLP_TOLERANCE
        if not answer.found:
            failed = f"quadratic_programme_failed: {answer.detail}"
            return failed if feasible else self._restore(jacobian)
        self._update_multipliers(equations, gradient, jacobian, hessian, step, answer)
        if feasible and float(np.abs(step[:k]).max()) <= SQP_STEP:
            return "solved"
        slope = float(gradient @ step)
        self.price = max(self.price, SQP_PENALTY * float(np.linalg.norm(self.multipliers)))
        promised = slope - self.price * here.violation
        if promised > -SQP_ROUNDING * (1 + abs(here.cost) + self.price * here.violation):
            return "solved" if feasible else "stalled"
        if not self._search(equations, step, promised):
            return "line_search_failed" if feasible else self._restore(jacobian)
        moved = float(np.abs(self.point.x[:k] - here.x[:k]).max())
        done = moved <= SQP_STEP and self.point.violation <= NLP_TOLERANCE
        return "solved" if done else None

    def _restore(self, jacobian: Array) -> str | None:
        """A step that only repairs: least squares of the linearised equations inside the limits.

        For where limits forbid to solve them all at once.
        """
        here, k = self.point, self.kinematic
        linear, residual = jacobian[: self.equalities, :k], here.constraints[: self.equalities]
        down, up = self._room()
        g, h = np.concatenate((np.eye(k), -np.eye(k))), np.concatenate((up, down))
        quadratic = linear.T @ linear + SQP_DAMPING * np.eye(k)
        answer = solve_quadratic(quadratic, linear.T @ residual, g, h, self.qp_solver)
        if not answer.found:
            return f"quadratic_programme_failed: {answer.detail}"
        step = np.zeros(len(here.x))
        step[:k] = answer.x
        ahead_if_linear = float(np.linalg.norm(residual + linear @ answer.x))
        promised = here.violation - ahead_if_linear
        if promised <= SQP_DECREASE * here.violation:
            return "locally_infeasible"
        share = 1.0
        for _ in range(SQP_HALVINGS):
            ahead = self._moved(here.x, share * step)
            if ahead.violation <= here.violation - SQP_DECREASE * share * promised:
                self.point = ahead
                return None
            share /= 2
        return "line_search_failed"

    def _guess_multipliers(self) -> None:
        """Multipliers as if every slack stood at a bound and no limit did."""
        x, k, programme = self.point.x, self.kinematic, self.instance.programme
        gradient, jacobian, _ = self.evaluator.derivatives(x, self.multipliers)
        pull = gradient[:k].copy()
        travel = x[programme.slack_of] - self.instance.slack_references
        np.add.at(pull, programme.slack_of, gradient[k:] * np.sign(travel))
        equations = _factorised(jacobian[: self.equalities, :k])
        if equations is not None:
            self.multipliers[: self.equalities] = equations.multipliers(pull)

    def _step(
        self, equations: _Equations, gradient: Array, jacobian: Array, hessian: Array
    ) -> tuple[Array, QuadraticAnswer]:
        """A step and the quadratic programme's answer."""
        here, k, equal = self.point, self.kinematic, self.equalities
        base = np.zeros(len(here.x))
        base[:k] = equations.shortest(here.constraints[:equal])
        free, slacks = equations.z.shape[1], len(here.x) - k
        basis = np.zeros((len(here.x), free + slacks))
        basis[:k, :free] = equations.z
        basis[k:, free:] = np.eye(slacks)
        curved = equations.z.T @ hessian[:k, :k]
        quadratic = SQP_SLACK_CURVATURE * np.eye(free + slacks)
        quadratic[:free, :free] = _positive(curved @ equations.z)
        linear = basis.T @ gradient
        linear[:free] += curved @ base[:k]
        down, up = self._room()
        other = jacobian[equal:]
        moves = basis[:k]
        g = np.concatenate((moves, -moves, -(other @ basis)))
        h = np.concatenate(
            (up - base[:k], down + base[:k], here.constraints[equal:] + other @ base)
        )
        if here.violation <= NLP_TOLERANCE:
            # Standing still is allowed then: an end below zero is what rounding has left.
            h = np.maximum(h, 0.0)
        answer = solve_quadratic(quadratic, linear, g, h, self.qp_solver)
        return base + basis @ answer.x, answer

    def _room(self) -> tuple[Array, Array]:
        """How far each variable may go down and up in a step."""
        x = self.point.x[: self.kinematic]
        low, high = self.instance.lower[: len(x)], self.instance.upper[: len(x)]
        return np.minimum(x - low, SQP_LONGEST_STEP), np.minimum(high - x, SQP_LONGEST_STEP)

    def _update_multipliers(
        self,
        equations: _Equations,
        gradient: Array,
        jacobian: Array,
        hessian: Array,
        step: Array,
        answer: QuadraticAnswer,
    ) -> None:
        k, equal = self.kinematic, self.equalities
        others = answer.z[2 * k : 2 * k + len(self.multipliers) - equal]
        pull = gradient[:k] + hessian[:k, :k] @ step[:k] - jacobian[equal:, :k].T @ others
        pull += answer.z[:k] - answer.z[k : 2 * k]
        self.multipliers[:equal] = equations.multipliers(pull)
        self.multipliers[equal:] = -others

    def _search(self, equations: _Equations, step: Array, promised: float) -> bool:
        """Moves to a point of less merit on the step, if there is one."""
        here, k = self.point, self.kinematic
        before = here.cost + self.price * here.violation
        share = 1.0
        for _ in range(SQP_HALVINGS):
            allowed = before + SQP_DECREASE * share * promised
            allowed += SQP_ROUNDING * (1 + abs(before))
            ahead = self._moved(here.x, share * step)
            for _ in range(SQP_CORRECTIONS):
                if ahead.cost + self.price * ahead.violation <= allowed:
                    break
                correction = np.zeros_like(step)
                correction[:k] = equations.shortest(ahead.constraints[: self.equalities])
                corrected = self._moved(ahead.x, correction)
                if corrected.violation >= ahead.violation:
                    break
                ahead = corrected
            if ahead.cost + self.price * ahead.violation <= allowed:
                self.point = ahead
                return True
            share /= 2
        return False

    def _moved(self, x: Array, step: Array) -> _Point:
        return self._at(self.instance.inside(x + step))


def solve_by_sqp(robot: Robot, instance: Instance, qp_solver: str) -> ProgrammeResult:
    """Solves a programme; `status` is "solved" or says what stopped it."""
    search = _Search(robot, instance, qp_solver)
    for iteration in range(1, SQP_ITERATIONS + 1):
        status = search.iterate()
        if status is not None:
            return ProgrammeResult(status == "solved", status, iteration, search.point.x)
    return ProgrammeResult(False, "iteration_limit", SQP_ITERATIONS, search.point.x)


def _factorised(jacobian: Array) -> _Equations | None:
    rows = len(jacobian)
    q, r = np.linalg.qr(jacobian.T, mode="complete")
    if np.abs(np.diag(r)).min() < SQP_RANK:
        return None
    return _Equations(q[:, :rows], q[:, rows:], r[:rows])


def _positive(matrix: Array) -> Array:
    """The matrix with negative curvatures mirrored and small ones raised."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return np.asarray((vectors * np.maximum(np.abs(values), SQP_CURVATURE)) @ vectors.T)
