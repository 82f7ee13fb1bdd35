"""Plans as plain values; tests/app/services/plans/test_wire.py compares them with the wire."""

import json
from dataclasses import replace

import numpy as np
import pytest

from solver import Problem, Robot, Target, solve
from solver.frames.transforms import NamedFrame, RigidTransform
from solver.problem.plan import Plan
from tests.solver.problems import data_set_3


@pytest.fixture(scope="module")
def plan(tabletop: Robot) -> Plan:
    problem = data_set_3(tabletop, method="ssas")
    targets = [*problem.targets, Target("far", (2.0, 0.0, 0.0), (0.0, 1.0, 0.0))]
    frame = NamedFrame("camera", RigidTransform((0.1, 0.2, 0.3), (0.0, 0.0, 0.0, 1.0)))
    return solve(Problem(tabletop, targets, problem.options, frame=frame))


def test_it_has_the_names_of_the_wire(plan: Plan) -> None:
    plain = plan.to_dict()
    assert json.loads(plan.to_json()) == plain
    assert plain["robot"] == "tabletop"
    assert plain["frame_transform"]["position_m"] == [0.1, 0.2, 0.3]
    assert plain["summary"]["planned"] == 5
    assert plain["approaches"][0]["target_id"] == "1"
    assert plain["approaches"][-1]["reason"]["code"] == "out_of_reach"


def test_nothing_is_none_and_every_number_is_pythons_own(plan: Plan) -> None:
    def leaves(value: object) -> list[object]:
        if isinstance(value, dict):
            return [leaf for inner in value.values() for leaf in leaves(inner)]
        if isinstance(value, list):
            return [leaf for inner in value for leaf in leaves(inner)]
        return [value]

    assert {type(leaf) for leaf in leaves(plan.to_dict())} <= {str, float, int, bool}


def test_a_number_that_is_not_finite_is_refused(plan: Plan) -> None:
    first, *others = plan.approaches
    for changes in ({"effort": np.inf}, {"standby_joints": np.full(6, np.nan)}):
        with pytest.raises(ValueError, match="not finite"):
            replace(plan, approaches=(replace(first, **changes), *others)).to_dict()


def test_it_is_shown_in_a_line(plan: Plan) -> None:
    shown = repr(plan)
    assert shown.startswith("<Plan for tabletop: 5 planned, 1 infeasible, total effort ")
    assert len(shown) < 80
