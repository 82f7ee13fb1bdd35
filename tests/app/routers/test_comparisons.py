"""Comparisons over HTTP: taken on, run in a solver process, kept, shown as JSON and as a page."""

import asyncio
import os
import signal
import time
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.reports.html import content_security_policy
from app.services.comparisons.service import MOST_ACTIVE, ComparisonService
from app.services.exceptions import Unavailable
from app.store import ComparisonStore
from solver.comparison.registry import SCENARIOS
from tests.app.conftest import Server, assert_problem, running_server, wait_until

Body = dict[str, Any]
QUICK: Body = {"scenario": "strawberry", "methods": ["as", "ncos"], "repeats": 1}
# A minute and more, if nobody ends it.
LONG: Body = {"scenario": "strawberry", "methods": ["ncos"], "repeats": 400}
COMPLETE_S = 120


def post(server: Server, body: Body) -> Body:
    answer = server.client.post("/v1/comparisons", json=body)
    assert answer.status_code == 202, answer.text
    comparison: Body = answer.json()
    assert answer.headers["location"] == f"/v1/comparisons/{comparison['id']}"
    return comparison


def get(server: Server, comparison_id: str) -> Body:
    answer = server.client.get(f"/v1/comparisons/{comparison_id}")
    assert answer.status_code == 200, answer.text
    comparison: Body = answer.json()
    return comparison


def page(server: Server, comparison_id: str) -> httpx2.Response:
    return server.client.get(
        f"/v1/comparisons/{comparison_id}", headers={"Accept": "text/html,*/*;q=0.8"}
    )


def test_a_comparison_is_run_and_kept(server: Server) -> None:
    taken_on = post(server, QUICK)
    assert taken_on["status"] == "queued"
    assert {name: taken_on[name] for name in QUICK} == QUICK
    wait_until(lambda: get(server, taken_on["id"])["status"] == "completed", COMPLETE_S)
    comparison = get(server, taken_on["id"])
    assert comparison["created_at"] <= comparison["started_at"] <= comparison["ended_at"]
    assert "progress" not in comparison
    result = comparison["result"]
    assert result["scenario"] == "strawberry"
    assert {row["method"] for row in result["rows"]} == {"as", "ncos"}
    assert len(result["rows"]) == 40
    assert all(row["solved"] for row in result["rows"])

    shown = page(server, taken_on["id"])
    assert shown.headers["content-type"].startswith("text/html")
    assert shown.headers["content-security-policy"].startswith(content_security_policy())
    assert "data:image/png;base64," in shown.text
    assert "script" not in shown.text
    assert result["title"] in shown.text


def test_a_running_comparison_tells_how_far_it_is(tmp_path: Path) -> None:
    """Another waits for it; both are failed when the service has been started again."""
    with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
        running, waiting = post(server, LONG), post(server, QUICK)
        wait_until(lambda: "progress" in get(server, running["id"]), COMPLETE_S)
        comparison = get(server, running["id"])
        assert comparison["status"] == "running"
        assert comparison["progress"]["rows_total"] == 20
        assert 1 <= comparison["progress"]["rows_done"] <= 20
        assert "rows" in page(server, running["id"]).text
        assert 'http-equiv="refresh"' in page(server, running["id"]).text
        assert get(server, waiting["id"])["status"] == "queued"
        started = time.monotonic()
    assert time.monotonic() - started < 20, "the service waited for its comparisons"
    with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
        for comparison_id in (running["id"], waiting["id"]):
            comparison = get(server, comparison_id)
            assert comparison["status"] == "failed"
            assert "started again" in comparison["detail"]
            assert comparison["ended_at"]
            shown = page(server, comparison_id)
            assert "started again" in shown.text
            assert "refresh" not in shown.text

        # A solver process that dies over one is no end of the service either.
        lost, after = post(server, LONG), post(server, QUICK)
        wait_until(lambda: "progress" in get(server, lost["id"]), COMPLETE_S)
        (worker,) = server.children()
        os.kill(worker, signal.SIGKILL)
        wait_until(lambda: get(server, lost["id"])["status"] == "failed", 30)
        assert "lost" in get(server, lost["id"])["detail"]
        wait_until(lambda: get(server, after["id"])["status"] == "completed", COMPLETE_S)


def test_scenarios_are_listed(server: Server) -> None:
    listed = server.client.get("/v1/scenarios").json()["scenarios"]
    assert [row["name"] for row in listed] == list(SCENARIOS)
    assert all(row["title"] for row in listed)


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"scenario": "nowhere"}, "#/scenario"),
        ({"scenario": "../../etc/passwd"}, "#/scenario"),
        ({"scenario": "openapi/examples/data_set_3.json"}, "#/scenario"),
        ({"scenario": 1}, "#/scenario"),
        ({"methods": ["as", "magic"]}, "#/methods/1"),
        ({"methods": []}, "#/methods"),
        ({"methods": "as"}, "#/methods"),
        ({"repeats": 0}, "#/repeats"),
        ({"repeats": 1001}, "#/repeats"),
        ({"repeats": 1.5}, "#/repeats"),
        ({"repeats": None}, "#/repeats"),
        ({"colour": "red"}, "#/colour"),
    ],
)
def test_requests_that_make_no_sense(server: Server, changes: Body, pointer: str) -> None:
    answer = server.client.post("/v1/comparisons", json=QUICK | changes)
    problem = assert_problem(answer, 422, pointer)
    assert "magic" not in answer.text
    assert "passwd" not in answer.text
    if pointer == "#/scenario" and isinstance(changes["scenario"], str):
        assert "strawberry" in problem["errors"][0]["detail"]


def test_bodies_that_are_none(server: Server) -> None:
    post_raw = server.client.post
    assert_problem(post_raw("/v1/comparisons", content=b"not JSON"), 422)
    answer = post_raw("/v1/comparisons", content=b"{}", headers={"Content-Type": "text/plain"})
    assert_problem(answer, 415)


class FullStore(ComparisonStore):
    def __init__(self) -> None:
        pass

    def count_active(self) -> int:
        return MOST_ACTIVE


def test_more_than_anybody_waits_for_are_refused() -> None:
    async def create() -> None:
        # Neither is used before it is refused.
        service = ComparisonService(FullStore(), None)  # type: ignore[arg-type]
        try:
            await service.create("strawberry", None, None)
        finally:
            await service.close()

    with pytest.raises(Unavailable) as raised:
        asyncio.run(create())
    assert raised.value.code == "comparisons_full"


@pytest.mark.parametrize("comparison_id", ["0" * 32, "nowhere", "%27"])
def test_unknown_comparisons(server: Server, comparison_id: str) -> None:
    assert_problem(server.client.get(f"/v1/comparisons/{comparison_id}"), 404)
    assert_problem(page(server, comparison_id), 404)
