from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.solving import many_targets
from solver.solving.many_targets import plan_many
from solver.verification.many import judge_many
from tests.solver.problems import random_targets


def test_nothing_that_is_wrong_is_called_planned(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = Options(method="ssas", order="independent", include=("path",))
    problem = Problem(tabletop, random_targets(seed=90, count=40), options=options)
    seen = []

    def note(problem, proposed, reports):  # type: ignore[no-untyped-def]
        seen.append((proposed, reports))
        return judge_many(problem, proposed, reports)

    monkeypatch.setattr(many_targets, "judge_many", note)
    assert plan_many(problem, problem.targets)
    ((proposed, reports),) = seen
    n = len(proposed.target_ids)
    bent = proposed.paths.copy()
    bent[:, 7, 2] += 1e-4
    shifted = proposed.paths.copy()
    shifted[..., 0] += 1e-4
    holed = proposed.paths.copy()
    holed[:, 3, 3] = np.nan
    for wrong in (
        replace(proposed, paths=bent),
        replace(proposed, paths=shifted),
        replace(proposed, paths=holed),
        replace(proposed, angles_rad=proposed.angles_rad + 1e-4),
        replace(proposed, tool_sides=-proposed.tool_sides),
        replace(proposed, branches=(proposed.branches + 1) % 8),
        replace(proposed, positions=proposed.positions + 1e-4),
    ):
        assert judge_many(problem, wrong, reports) == {}
    beyond = replace(problem, options=replace(problem.options, limit_margin_rad=0.4))
    kept = judge_many(beyond, proposed, reports)
    assert len(kept) < n
    assert all((approach.margin_rad or 0) >= 0.4 for approach in kept.values())
