"""From the wire to the solver and back."""

import json
from typing import Any

from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import Options, feasible_arcs, solve
from solver.problem.options import DEFAULT_POSITION_MARGIN_M

Body = dict[str, Any]


OUT_OF_REACH = {"id": "far", "position_m": [2.0, 0.0, 0.3], "branch_direction": [0, 1, 0]}


def has_null(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(has_null, value.values()))
    return any(map(has_null, value)) if isinstance(value, list) else value is None


def test_arcs_tell_where_each_branch_is_feasible(request_body: Body) -> None:
    request_body["targets"].insert(2, OUT_OF_REACH)
    request_body["options"] = {"include": ["arcs"]}
    problem = problem_from_wire(parse_request(json.dumps(request_body).encode()))
    plan = plan_to_wire(solve(problem), "0")
    assert not has_null(plan)
    of_problem = feasible_arcs(problem)
    for approach in plan["approaches"]:
        arcs = approach["arcs"]
        assert [(arc["lower_rad"], arc["upper_rad"]) for arc in arcs] == [
            (arc.lower_rad, arc.upper_rad) for arc in of_problem[approach["target_id"]]
        ]
        ends = {*problem.robot.joint_names, "reach", "wrist_jump"}
        assert all({arc["lower_limit"], arc["upper_limit"]} <= ends for arc in arcs)
        if approach["status"] == "infeasible":
            assert arcs == []
            continue
        assert any(
            (arc["tool_side"], arc["branch"]) == (approach["tool_side"], approach["branch"])
            and arc["lower_rad"] <= approach["approach_angle_rad"] <= arc["upper_rad"]
            for arc in arcs
        )


def test_options_are_all_known_to_the_solver(request_body: Body) -> None:
    given = {
        "method": "ssas", "order": "independent", "norm": "l2", "weights": "uniform",
        "joint_weights": [1, 2, 3, 4, 5, 6], "standoff_m": 0.03, "path_points": 11,
        "straightness_m": 0.001, "dwell_s": 1, "limit_margin_rad": 0.01, "symmetric_tool": True,
        "strike_zone_m": 0.01, "tilt_tolerance_rad": 0.1, "position_margin_m": 0.002,
        "samples": 20, "seed": 3,
        "certify": False, "nlp_backend": "ipopt", "qp_solver": "osqp", "include": ["path"],
    }  # fmt: skip
    request_body["options"] = given
    problem = problem_from_wire(parse_request(json.dumps(request_body).encode()))
    assert {name: getattr(problem.options, name) for name in given} == {
        **given, "joint_weights": (1, 2, 3, 4, 5, 6), "include": ("path",),
    }  # fmt: skip
    assert set(given) == set(Options.__dataclass_fields__)


def test_the_margin_is_told_where_it_is_asked_for(request_body: Body) -> None:
    told = []
    for margin_m in (None, 0.0, 0.05):
        options = {"method": "ssas", "include": ["path"]}
        request_body["options"] = (
            options if margin_m is None else {**options, "position_margin_m": margin_m}
        )
        problem = problem_from_wire(parse_request(json.dumps(request_body).encode()))
        answer = plan_to_wire(solve(problem), "id")
        told.append((answer["options"]["position_margin_m"], answer["approaches"]))
    (default, with_margin), (zero, without), (large, short) = told
    assert (default, zero, large) == (DEFAULT_POSITION_MARGIN_M, 0.0, 0.05)
    for approach in with_margin:
        assert approach["position_margin_m"] == default
        assert "margin_short" not in approach
    assert not any({"position_margin_m", "margin_short"} & set(one) for one in without)
    for approach in short:
        assert approach["position_margin_m"] < large
        assert approach["margin_short"] is True


def test_bounds_and_proofs_are_told(request_body: Body) -> None:
    request_body["targets"].append(
        {"id": "far", "position_m": [0.9, 0.0, 0.3], "branch_direction": [0, 1, 0]}
    )
    # In a batch a bound counts from where the approach before it has left the arm.
    for certify, order in (
        (True, "independent"),
        (True, "given"),
        (True, "optimal"),
        (False, "given"),
    ):
        request_body["options"] = {"method": "ssas", "certify": certify, "order": order}
        problem = problem_from_wire(parse_request(json.dumps(request_body).encode()))
        *planned, far = plan_to_wire(solve(problem), "0")["approaches"]
        assert [approach["status"] for approach in planned] == ["planned"] * 5
        assert all(("lower_bound" in approach) is certify for approach in planned)
        assert far["reason"].get("proven") is (True if certify else None)


def test_it_is_the_solvers_own_plain_values(request_body: Body) -> None:
    request_body["targets"].append(OUT_OF_REACH)
    plan = solve(problem_from_wire(parse_request(json.dumps(request_body).encode())))
    wire = plan_to_wire(plan, "an id")
    assert wire.pop("id") == "an id"
    assert wire.pop("version")
    assert wire == plan.to_dict()
