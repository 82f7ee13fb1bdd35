"""Idempotency-Key over HTTP: on every route that creates, across refusals, threads and deaths."""

import concurrent.futures
import contextlib
import json
import sqlite3
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.routers.idempotency_key import HEADER, LONGEST_KEY, REPLAYED
from tests.app.conftest import EXAMPLE, Server, assert_problem, running_server
from tests.app.execution_requests import assert_code, make_plan, wait_for_status
from tests.app.fake_worker import FakeWorker, worker

Body = dict[str, Any]
COMPARISON: Body = {"scenario": "strawberry", "methods": ["as"], "repeats": 1}
PLANS, EXECUTIONS, COMPARISONS = "/v1/plans", "/v1/executions", "/v1/comparisons"
MISSING_PLAN: Body = {"plan_id": "0" * 32, "robot": "tabletop-sim"}


def plan_body(**options: Any) -> Body:
    body: Body = json.loads(EXAMPLE.read_text())
    body["options"] = {"method": "ssas", **options}
    return body


@dataclass
class Route:
    """A route that creates, with a body that is good once and one that never is."""

    server: Server
    path: str
    table: str
    good: Body
    bad: Body
    fake: FakeWorker | None = None

    def post(self, key: str, body: Body, path: str = "") -> httpx2.Response:
        return post(self.server, path or self.path, key, body)

    def count(self) -> int:
        return count(self.server, self.table)

    def finish(self, answer: httpx2.Response) -> None:
        """What is under way is done, so that the next can begin."""
        if self.fake is not None:
            execute, _ = self.fake.order()
            # The only order since the last: a duplicate that was sent would be here instead.
            assert execute.execution_id == answer.json()["id"]
            self.fake.account(execute.execution_id, "completed")
            wait_for_status(self.server, answer.json(), "completed")


def post(server: Server, path: str, key: str, body: Body) -> httpx2.Response:
    return server.client.post(path, json=body, headers={HEADER: key})


def count(server: Server, table: str) -> int:
    file = server.data_dir / "prunus.sqlite3"
    with contextlib.closing(sqlite3.connect(file)) as database:
        found: int = database.execute(f"SELECT count(*) FROM {table}").fetchone()[0]
        return found


def new_key() -> str:
    return uuid.uuid4().hex


@pytest.fixture(params=[PLANS, EXECUTIONS, COMPARISONS])
def route(request: pytest.FixtureRequest, server: Server) -> Iterator[Route]:
    if request.param == PLANS:
        yield Route(server, PLANS, "plans", plan_body(), plan_body(method="none"))
    elif request.param == COMPARISONS:
        yield Route(server, COMPARISONS, "comparisons", COMPARISON, {"scenario": "none"})
    else:
        order = {"plan_id": make_plan(server)["id"], "robot": "tabletop-sim"}
        with worker(server) as fake:
            yield Route(server, EXECUTIONS, "executions", order, MISSING_PLAN, fake)


def assert_replay(again: httpx2.Response, first: httpx2.Response) -> None:
    assert REPLAYED not in first.headers
    assert again.headers[REPLAYED] == "true"
    assert (again.status_code, again.content) == (first.status_code, first.content)
    for name in ("location", "content-type"):
        assert again.headers[name] == first.headers[name]


def test_a_duplicate_gets_the_stored_answer_and_creates_nothing(route: Route) -> None:
    key, before = new_key(), route.count()
    first = route.post(key, route.good)
    assert first.status_code in (201, 202), first.text
    for _ in range(2):
        assert_replay(route.post(key, route.good), first)
    assert route.count() == before + 1
    route.finish(first)
    # An answer is the first one for ever, whatever has become of what it created.
    assert_replay(route.post(key, route.good), first)
    other = route.post(new_key(), route.good)
    assert other.headers["location"] != first.headers["location"]
    assert REPLAYED not in other.headers
    assert route.count() == before + 2
    route.finish(other)


def test_another_body_is_refused(route: Route) -> None:
    key = new_key()
    first = route.post(key, route.good)
    route.finish(first)
    before = route.count()
    for other in (route.bad, {**route.good, "robot": "nobody"}):
        assert_code(route.post(key, other), 422, "idempotency_key_reused")
    # To the byte: what is not the same body is another one.
    spaced = route.server.client.post(
        route.path, content=json.dumps(route.good, indent=3), headers={HEADER: key}
    )
    assert_code(spaced, 422, "idempotency_key_reused")
    assert route.count() == before
    assert_replay(route.post(key, route.good), first)


def test_what_was_refused_is_not_kept(route: Route) -> None:
    key, keys = new_key(), count(route.server, "idempotency_keys")
    for _ in range(2):
        refused = route.post(key, route.bad)
        assert_problem(refused, 404 if route.path == EXECUTIONS else 422)
        assert REPLAYED not in refused.headers
    assert count(route.server, "idempotency_keys") == keys
    answer = route.post(key, route.good)
    assert answer.status_code in (201, 202), answer.text
    assert REPLAYED not in answer.headers
    route.finish(answer)


def test_a_key_means_another_thing_on_another_path(server: Server) -> None:
    key = new_key()
    plan = post(server, PLANS, key, plan_body())
    comparison = post(server, COMPARISONS, key, COMPARISON)
    assert (plan.status_code, comparison.status_code) == (201, 202)
    assert REPLAYED not in comparison.headers


@pytest.mark.parametrize(
    "headers",
    [
        [(HEADER, b"")],
        [(HEADER, b"two words")],
        [(HEADER, b"k" * (LONGEST_KEY + 1))],
        [(HEADER, "schlüssel".encode("latin-1"))],
        [(HEADER, b"tab\there")],
        [(HEADER, b"one"), (HEADER, b"other")],
        [(HEADER, b"same"), (HEADER, b"same")],
    ],
    ids=["empty", "space", "long", "not ASCII", "tab", "two", "twice"],
)
def test_a_key_that_makes_no_sense_is_refused(route: Route, headers: Any) -> None:
    before = route.count()
    pairs = [(name.encode(), value) for name, value in headers]
    body = json.dumps(route.good).encode()
    answer = route.server.client.post(route.path, content=body, headers=pairs)
    assert_code(answer, 422, "invalid_idempotency_key")
    assert route.count() == before


def test_the_longest_key_of_any_visible_characters_is_taken(server: Server) -> None:
    visible = "".join(map(chr, range(0x21, 0x7F)))
    key = (new_key() + visible * 3)[:LONGEST_KEY]
    first = post(server, PLANS, key, plan_body())
    assert_replay(post(server, PLANS, key, plan_body()), first)


def test_concurrent_duplicates_run_once(server: Server) -> None:
    key, before = new_key(), server.stored_plans()
    body = plan_body(method="ncos")
    with concurrent.futures.ThreadPoolExecutor(8) as executor:
        answers = list(executor.map(lambda _: post(server, PLANS, key, body), range(8)))
    assert server.stored_plans() == before + 1
    assert sum(REPLAYED not in answer.headers for answer in answers) == 1
    assert {answer.status_code for answer in answers} == {201}
    assert len({(answer.content, answer.headers["location"]) for answer in answers}) == 1


def test_an_execution_that_no_worker_took_is_ordered_again_with_the_same_key(
    server: Server,
) -> None:
    order = {"plan_id": make_plan(server)["id"], "robot": "tabletop-sim"}
    key = new_key()
    assert_code(post(server, EXECUTIONS, key, order), 503, "no_worker")
    with worker(server) as fake:
        first = post(server, EXECUTIONS, key, order)
        assert first.status_code == 202
        # The robot is busy with the very same.
        assert_replay(post(server, EXECUTIONS, key, order), first)
        assert_code(post(server, EXECUTIONS, new_key(), order), 409, "busy")
        fake.order()
    # Without a worker too, the answer is what it was.
    assert_replay(post(server, EXECUTIONS, key, order), first)


def test_keys_outlive_the_service(tmp_path: Path) -> None:
    """Ended in order after the first, killed after the second."""
    sent: list[tuple[str, str, Body, httpx2.Response]] = []
    for death in ("interrupt", "kill", ""):
        with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
            for path, key, body, first in sent:
                assert_replay(post(server, path, key, body), first)
                assert_code(post(server, path, key, {}), 422, "idempotency_key_reused")
            assert count(server, "idempotency_keys") == len(sent)
            for path, body in ((PLANS, plan_body()), (COMPARISONS, COMPARISON)):
                key = new_key()
                sent.append((path, key, body, post(server, path, key, body)))
            if death == "kill":
                server.process.kill()
                server.process.wait()


def test_a_registration_that_comes_late_does_not_undo_a_newer_one(server: Server) -> None:
    path = "/v1/frames/late-camera/registration"
    points = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.1]]
    old, new = (
        {
            "pairs": [
                {"frame_m": point, "base_m": [point[0] + shift, *point[1:]]} for point in points
            ]
        }
        for shift in (0.1, 0.2)
    )
    key = new_key()
    first = post(server, path, key, old)
    assert first.status_code == 201, first.text
    assert post(server, path, new_key(), new).status_code == 201
    newer = server.client.get("/v1/frames/late-camera").content
    assert_replay(post(server, path, key, old), first)
    assert_code(post(server, path, key, new), 422, "idempotency_key_reused")
    assert server.client.get("/v1/frames/late-camera").content == newer != first.content


def test_a_lease_is_given_again_as_long_as_it_lasts(server: Server) -> None:
    path, key = "/v1/robots/puma560/lease", new_key()
    asked = {"holder": "row 7"}
    first = post(server, path, key, asked)
    again = post(server, path, key, asked)
    assert (first.status_code, again.status_code) == (201, 201)
    assert first.json() == again.json()
    assert REPLAYED not in first.headers
    assert again.headers[REPLAYED] == "true"
    assert again.headers["location"] == first.headers["location"]
    assert_code(post(server, path, key, {"holder": "row 8"}), 422, "idempotency_key_reused")
    assert_code(post(server, path, new_key(), asked), 409, "leased")
    assert server.client.delete(first.headers["location"]).status_code == 204


def test_every_operation_that_creates_takes_a_key(server: Server) -> None:
    """As the document says; these are the routes tested above."""
    paths = server.client.get("/openapi.json").json()["paths"]
    taking, creating = set(), set()
    for path, operations in paths.items():
        operation = operations.get("post", {})
        if any(entry["name"] == HEADER for entry in operation.get("parameters", ())):
            taking.add(path)
            assert "422" in operation["responses"]
        if any(
            "Location" in entry.get("headers", ())
            for entry in operation.get("responses", {}).values()
        ):
            creating.add(path)
    assert taking == creating
    assert {PLANS, EXECUTIONS, COMPARISONS} <= taking
