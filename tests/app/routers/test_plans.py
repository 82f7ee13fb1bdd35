import json
import math
import sqlite3
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import Options, Problem, Target, feasible_arcs, load_robot, solve
from tests.app.conftest import EXAMPLE, REPOSITORY, Server, running_server

Body = dict[str, Any]
OUT_OF_REACH = {"id": "far", "position_m": [2.0, 0.0, 0.3], "branch_direction": [0, 1, 0]}


def post(server: Server, body: Body) -> Body:
    answer = server.client.post("/v1/plans", json=body)
    assert answer.status_code == 201, answer.text
    plan: Body = answer.json()
    assert answer.headers["location"] == f"/v1/plans/{plan['id']}"
    return plan


def comparable(plan: Body) -> Body:
    """The plan without what differs from run to run: its id and times taken."""

    def strip(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: strip(part) for key, part in value.items() if key != "elapsed_s"}
        return [strip(part) for part in value] if isinstance(value, list) else value

    stripped: Body = strip({key: value for key, value in plan.items() if key != "id"})
    return stripped


def has_null(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(has_null, value.values()))
    return any(map(has_null, value)) if isinstance(value, list) else value is None


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app", *arguments],
        cwd=REPOSITORY, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


def test_data_set_3_is_planned(server: Server) -> None:
    plan = post(server, json.loads(EXAMPLE.read_text()))
    assert plan["summary"]["planned"] == 5
    assert plan["robot"] == "tabletop"
    assert plan["tool"] == "laser"
    assert [approach["target_id"] for approach in plan["approaches"]] == list("12345")
    for approach in plan["approaches"]:
        assert approach["status"] == "planned"
        assert len(approach["path_joints"]) == plan["options"]["path_points"]
        assert approach["path_joints"][0] == approach["standby_joints"]
        assert approach["path_joints"][-1] == approach["thinning_joints"]
        names = [segment["name"] for segment in approach["trajectory"]["segments"]]
        assert names == ["transfer", "cut_in", "dwell", "retreat"]
    assert plan["joint_weights"] == [1.0] * 6
    assert "joint_weights" not in plan["options"]
    assert not has_null(plan)


def test_unreachable_target_is_an_answer(server: Server, request_body: Body) -> None:
    request_body["targets"].insert(2, OUT_OF_REACH)
    plan = post(server, request_body)
    assert plan["summary"]["planned"] == 5
    assert plan["summary"]["infeasible"] == 1
    far = plan["approaches"][2]
    assert far["target_id"] == "far"
    assert far["status"] == "infeasible"
    assert far["reason"]["code"] == "out_of_reach"
    assert far["reason"]["detail"]
    assert "thinning_joints" not in far
    assert not has_null(plan)


@pytest.mark.parametrize("include", [[], ["path"], ["transfer"], ["trajectory"], ["arcs"]])
def test_include_decides_what_is_sent(
    include: list[str], server: Server, request_body: Body
) -> None:
    request_body["options"]["include"] = include
    plan = post(server, request_body)
    assert plan["options"]["include"] == include
    fields = {"path": "path_joints", **{name: name for name in ("transfer", "trajectory", "arcs")}}
    for approach in plan["approaches"]:
        assert {name for name, field in fields.items() if field in approach} == set(include)


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


def test_plan_is_read_again(server: Server, request_body: Body) -> None:
    plan = post(server, request_body)
    path = f"/v1/plans/{plan['id']}"
    assert server.client.get(path).json() == plan
    lines = server.client.get(path, headers={"Accept": "application/x-ndjson"})
    assert lines.headers["content-type"].startswith("application/x-ndjson")
    assert [json.loads(line) for line in lines.text.splitlines()] == plan["approaches"]


def test_plan_survives_a_restart(tmp_path: Path, request_body: Body) -> None:
    with running_server(tmp_path, PRUNUS_WORKERS="1") as first:
        plan = post(first, request_body)
    with running_server(tmp_path, PRUNUS_WORKERS="1") as second:
        assert second.client.get(f"/v1/plans/{plan['id']}").json() == plan
        assert second.stored_plans() == 1
    with sqlite3.connect(tmp_path / "prunus.sqlite3") as database:
        stored = database.execute("SELECT robot, request FROM plans").fetchone()
    database.close()
    assert stored[0] == "tabletop"
    assert json.loads(stored[1]) == request_body


def test_same_plan_over_http_command_line_and_python(server: Server, tmp_path: Path) -> None:
    body = json.loads(EXAMPLE.read_text())
    over_http = post(server, body)

    written = tmp_path / "plan.json"
    finished = run("plan", str(EXAMPLE), "-o", str(written))
    assert finished.returncode == 0, finished.stderr
    by_command = json.loads(written.read_text())

    targets = [
        Target(target["id"], target["position_m"], target["branch_direction"])
        for target in body["targets"]
    ]
    options = Options(**body["options"])
    problem = Problem(load_robot("tabletop"), targets, "laser", body["start_joints"], options)
    in_python = plan_to_wire(solve(problem), "python")

    assert by_command["summary"]["planned"] == 5
    assert comparable(by_command) == comparable(over_http)
    assert comparable(in_python) == comparable(over_http)


def test_options_are_all_known_to_the_solver(request_body: Body) -> None:
    given = {
        "method": "ssas", "order": "independent", "norm": "l2", "weights": "uniform",
        "joint_weights": [1, 2, 3, 4, 5, 6], "standoff_m": 0.03, "path_points": 11,
        "straightness_m": 0.001, "dwell_s": 1, "limit_margin_rad": 0.01, "symmetric_tool": True,
        "strike_zone_m": 0.01, "tilt_tolerance_rad": 0.1, "samples": 20, "seed": 3,
        "certify": False, "nlp_backend": "ipopt", "qp_solver": "osqp", "include": ["path"],
    }  # fmt: skip
    request_body["options"] = given
    problem = problem_from_wire(parse_request(json.dumps(request_body).encode()))
    assert {name: getattr(problem.options, name) for name in given} == {
        **given, "joint_weights": (1, 2, 3, 4, 5, 6), "include": ("path",),
    }  # fmt: skip
    assert set(given) == set(Options.__dataclass_fields__)


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


def test_robots(server: Server) -> None:
    listed = server.client.get("/v1/robots").json()["robots"]
    assert "tabletop" in {robot["name"] for robot in listed}
    robot = server.client.get("/v1/robots/tabletop").json()
    assert len(robot["joints"]) == len(robot["home_joints"]) == 6
    assert all(joint["velocity_rad_s"] > 0 for joint in robot["joints"])
    assert {tool["name"] for tool in robot["tools"]} == {"laser", "scaffold"}
    assert all(tool["reach_m"] > 0 for tool in robot["tools"])
    assert robot["model_version"]


def test_a_rail_is_told_in_metres(server: Server) -> None:
    robot = server.client.get("/v1/robots/puma560_rail").json()
    rail, waist = robot["joints"][:2]
    assert (rail["kind"], waist["kind"]) == ("prismatic", "revolute")
    assert (rail["lower_m"], rail["upper_m"], rail["velocity_m_s"]) == (-0.6, 0.6, 0.5)
    assert not [name for name in rail if name.endswith(("_rad_s", "_rad_s2")) or "er_rad" in name]
    assert not [name for name in waist if name.startswith(("lower_m", "upper_m", "velocity_m"))]
    assert waist["upper_rad"] == pytest.approx(math.radians(160))
    assert robot["mount_rpy_rad"] == pytest.approx([-math.pi / 2, 0, 0])
    assert len(robot["home_joints"]) == 7
    assert "estimated" in robot["mass_source"]
    listed = {entry["name"] for entry in server.client.get("/v1/robots").json()["robots"]}
    assert {"puma560", "puma560_rail", "tabletop", "tabletop-sim"} <= listed
    assert not {"puma560-sim", "puma560_rail-sim"} & listed


def test_a_plan_on_a_rail(server: Server) -> None:
    body = {
        "robot": "puma560_rail",
        "targets": [{"id": "1", "position_m": [0.55, 1.25, 0.9], "branch_direction": [1, 0.3, 0]}],
        "options": {"method": "floating_z", "samples": 12, "weights": "torque"},
    }
    answer = server.client.post("/v1/plans", json=body)
    assert answer.status_code == 201, answer.text
    plan = answer.json()
    (approach,) = plan["approaches"]
    assert approach["status"] == "planned"
    assert len(approach["thinning_joints"]) == len(plan["joint_weights"]) == 7
    assert approach["thinning_joints"][0] > 0.3
