"""Plans and executions over HTTP, as several tests ask for them."""

import contextlib
import json
import sqlite3
from functools import cache
from typing import Any

import httpx2

from tests.app.conftest import EXAMPLE, Server, assert_problem
from tests.app.fake_worker import FakeWorker, wait_for

Body = dict[str, Any]
FAR = {"id": "far", "position_m": [2.0, 0.0, 0.3], "branch_direction": [0, 1, 0]}


def make_plan(server: Server, *, copies: int = 1, far: bool = False, **options: Any) -> Body:
    """Data set 3, several times over, as a plan of the service."""
    body = json.loads(EXAMPLE.read_text())
    targets = body["targets"]
    if copies > 1:
        targets = [{**t, "id": f"{k}-{t['id']}"} for k in range(copies) for t in targets]
    if far:
        targets.insert(1, FAR)
    body |= {"targets": targets, "options": {"method": "ssas", **options}}
    answer = server.client.post("/v1/plans", json=body)
    assert answer.status_code == 201, answer.text
    plan: Body = answer.json()
    return plan


@cache
def large_plan(server: Server) -> Body:
    """300 targets, whose motions take seconds to build and to send."""
    return make_plan(server, copies=60, straightness_m=1e-6)


def post(server: Server, plan: Body | str, robot: str = "tabletop-sim") -> httpx2.Response:
    plan_id = plan if isinstance(plan, str) else plan["id"]
    return server.client.post("/v1/executions", json={"plan_id": plan_id, "robot": robot})


def start(server: Server, plan: Body, robot: str = "tabletop-sim") -> Body:
    answer = post(server, plan, robot)
    assert answer.status_code == 202, answer.text
    execution: Body = answer.json()
    assert answer.headers["location"] == f"/v1/executions/{execution['id']}"
    assert execution["status"] == "queued"
    return execution


def get(server: Server, execution: Body) -> Body:
    answer = server.client.get(f"/v1/executions/{execution['id']}")
    assert answer.status_code == 200, answer.text
    found: Body = answer.json()
    return found


def command(server: Server, execution: Body, name: str) -> httpx2.Response:
    return server.client.post(f"/v1/executions/{execution['id']}/{name}")


def wait_for_status(server: Server, execution: Body, status: str) -> Body:
    wait_for(lambda: get(server, execution)["status"] == status)
    return get(server, execution)


def tamper(server: Server, plan: Body, **changes: Any) -> None:
    """Change the plan as it is stored."""
    with contextlib.closing(sqlite3.connect(server.data_dir / "prunus.sqlite3")) as database:
        text = json.dumps({**plan, **changes})
        database.execute("UPDATE plans SET answer = ? WHERE id = ?", (text, plan["id"]))
        database.commit()


def executing(server: Server, fake: FakeWorker, plan: Body) -> Body:
    execution = start(server, plan)
    fake.order()
    fake.account(execution["id"], "executing", **{"1": "executing"})
    return wait_for_status(server, execution, "executing")


def assert_code(answer: Any, status: int, code: str) -> Body:
    problem = assert_problem(answer, status)
    assert problem["type"] == f"urn:prunus:problem:{code}", problem
    return problem
