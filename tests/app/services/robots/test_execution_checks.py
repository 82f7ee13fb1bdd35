"""What is not taken on, and why."""

from dataclasses import replace
from typing import Any

import pytest

from hardware.link.messages import Failure
from tests.app.conftest import Server, assert_problem
from tests.app.execution_requests import assert_code, command, make_plan, post, tamper
from tests.app.fake_worker import AT, IDLE, state, wait_for, worker

Body = dict[str, Any]
FAULT = Failure("servo_missing", "servo 11 does not answer", AT)


@pytest.fixture(scope="module")
def plan(server: Server) -> Body:
    return make_plan(server)


def test_refusals_before_a_worker_is_needed(server: Server, plan: Body) -> None:
    assert_code(post(server, "0" * 32), 404, "not_found")
    assert_code(post(server, "nonsense"), 404, "not_found")
    assert_code(post(server, plan, "nobody"), 404, "not_found")
    assert (
        "nothing was started" in assert_code(post(server, plan), 503, "no_worker")["detail"].lower()
    )
    far = make_plan(server, far=True)
    infeasible = [entry for entry in far["approaches"] if entry["status"] == "infeasible"]
    tamper(server, far, approaches=infeasible)
    assert_problem(post(server, far), 422, "#/plan_id")


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "#/plan_id"),
        ({"plan_id": "qq7z"}, "#/robot"),
        ({"plan_id": 1, "robot": "tabletop"}, "#/plan_id"),
        ({"plan_id": None, "robot": "tabletop"}, "#/plan_id"),
        ({"plan_id": "qq7z", "robot": "tabletop", "speed": 2}, "#/speed"),
        (["qq7z"], "#"),
    ],
)
def test_bodies_that_make_no_sense(server: Server, body: Any, pointer: str) -> None:
    answer = server.client.post("/v1/executions", json=body)
    assert_problem(answer, 422, pointer)
    assert "qq7z" not in answer.text


def test_body_of_another_media_type(server: Server) -> None:
    headers = {"Content-Type": "text/plain"}
    assert_problem(server.client.post("/v1/executions", content="{}", headers=headers), 415)


def test_refusals_of_a_connected_robot(server: Server, plan: Body) -> None:
    with worker(server, tool="scaffold"):
        assert_code(post(server, plan), 409, "tool_mismatch")
    with worker(server) as fake:
        older = make_plan(server)
        tamper(server, older, model_version="000000000000")
        assert_code(post(server, older), 409, "model_mismatch")
        other = make_plan(server)
        tamper(server, other, robot="another-robot")
        assert_code(post(server, other), 409, "model_mismatch")
        fake.telemetry = replace(IDLE, status="fault", faults=(FAULT,))
        wait_for(lambda: state(server)["status"] == "fault")
        assert "acknowledge" in assert_code(post(server, plan), 409, "fault")["detail"]
    listed = server.client.get("/v1/executions", params={"robot": "tabletop-sim"}).json()
    refused = {older["id"], other["id"]}
    assert not refused & {entry["plan_id"] for entry in listed["executions"]}


def test_unknown_executions(server: Server) -> None:
    for execution_id in ("0" * 32, "qq7z"):
        for name in ("pause", "resume", "cancel"):
            answer = command(server, {"id": execution_id}, name)
            assert_code(answer, 404, "not_found")
            assert "qq7z" not in answer.text
        assert_problem(server.client.get(f"/v1/executions/{execution_id}"), 404)
