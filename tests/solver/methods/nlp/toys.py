"""Programmes of two or three variables for the sequential method, in place of an arm's."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from solver.methods.nlp import sqp
from solver.methods.nlp.formulation import Programme, Shape
from solver.methods.nlp.instance import Instance

Expression = Callable[[Any], Any]

_MADE_ANEW = sqp._functions.__wrapped__


def toy(
    monkeypatch: pytest.MonkeyPatch,
    cost: Expression,
    equations: Expression,
    start: Sequence[float],
    limits: tuple[float | Sequence[float], float | Sequence[float]] = (-10.0, 10.0),
    weights: Sequence[float] = (),
    references: Sequence[float] = (),
) -> Instance:
    """Minimise cost(x) + weights |x - references| subject to equations(x) = 0 and limits."""
    k, slacks = len(start), len(weights)
    x, t = ca.SX.sym("x", k), ca.SX.sym("t", slacks)
    equal = ca.vertcat(equations(x))
    travel = x[:slacks] - ca.DM(list(references)) if slacks else ca.SX(0, 1)
    total = cost(x) + (ca.dot(ca.DM(list(weights)), t) if slacks else 0.0)
    nlp = {
        "x": ca.vertcat(x, t),
        "p": ca.SX.sym("p", 1),
        "f": ca.SX(total),
        "g": ca.vertcat(equal, t - travel, t + travel),
    }
    stand_in = SimpleNamespace(nlp=nlp)
    monkeypatch.setattr(sqp, "build_programme", lambda robot, shape: stand_in)
    functions = _MADE_ANEW(None, None)
    monkeypatch.setattr(sqp, "_functions", lambda robot, shape: functions)
    size = equal.numel()
    of = Programme(Shape("l1"), k, nlp, size, 2 * slacks, k, np.arange(slacks))
    low, high = (np.broadcast_to(np.asarray(end, dtype=float), k) for end in limits)
    free = np.full(slacks, np.inf)
    known = Instance(
        of,
        np.concatenate((start, np.zeros(slacks))).astype(float),
        np.zeros(1),
        np.concatenate((low, -free)),
        np.concatenate((high, free)),
        np.asarray(references, dtype=float),
    )
    return replace(known, x0=known.inside(known.x0))
