import json
import sqlite3
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from app.services.plans.wire import plan_to_wire
from solver import Options, Problem, Target, load_robot, solve
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
    problem = Problem(
        load_robot("tabletop"), targets, options, tool="laser", start_joints=body["start_joints"]
    )
    in_python = plan_to_wire(solve(problem), "python")

    assert by_command["summary"]["planned"] == 5
    assert comparable(by_command) == comparable(over_http)
    assert comparable(in_python) == comparable(over_http)


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
