"""A service off loopback, as its clients and workers meet it."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx2
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from app.guards.access import REVOKED
from app.services.access.tokens import new_token
from app.settings import Settings
from app.store import TokenStore, open_engine
from hardware.link.messages import Welcome
from tests.app.conftest import REPOSITORY, Server, assert_problem, running_server, wait_until
from tests.app.execution_requests import (
    assert_code,
    command,
    executing,
    make_plan,
    post,
    wait_for_status,
)  # fmt: skip
from tests.app.fake_worker import FakeWorker, closed, hello, link, link_url, state, worker

Body = dict[str, Any]
ORIGIN = "https://orchard.example"
WAIT_S = 30


class Tokens:
    """Tokens in the service's own store, made beside it."""

    def __init__(self, data_dir: Path) -> None:
        self.engine = open_engine(Settings(data_dir=data_dir).resolved_database_url)
        self.store = TokenStore(self.engine)
        self.made: list[str] = []

    def make(self, *scopes: str) -> str:
        token, row = new_token("test", scopes)
        self.store.add(row)
        self.made.append(token)
        return token

    def revoke(self, token: str) -> None:
        self.store.revoke(token.split("_")[1])


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Server, Tokens]]:
    """A service on every address, whose usual client may do everything."""
    data_dir = tmp_path_factory.mktemp("guarded")
    tokens = Tokens(data_dir)
    admin = tokens.make("admin")
    environment = {
        "PRUNUS_HOST": "0.0.0.0", "PRUNUS_WORKERS": "1", "PRUNUS_CORS_ORIGINS": ORIGIN,
    }  # fmt: skip
    with running_server(data_dir, stderr=None, **environment) as server:
        assert server.url.startswith("http://0.0.0.0:")
        server = replace(server, url=server.url.replace("0.0.0.0", "127.0.0.1"))
        server.client.headers["authorization"] = f"Bearer {admin}"
        yield server, tokens
    tokens.engine.dispose()


@contextlib.contextmanager
def client(server: Server, token: str | None) -> Iterator[httpx2.Client]:
    headers = {} if token is None else {"authorization": f"Bearer {token}"}
    with httpx2.Client(base_url=server.url, headers=headers, timeout=60, trust_env=False) as opened:
        yield opened


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app", *arguments],
        cwd=REPOSITORY,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def test_serve_refuses_off_loopback_without_a_token(tmp_path: Path) -> None:
    finished = run("serve", "--host", "0.0.0.0", "--port", "0", "--data-dir", str(tmp_path))
    assert finished.returncode == 1
    assert finished.stdout == ""
    assert len(finished.stderr.splitlines()) == 1
    assert "prunus token create" in finished.stderr
    tokens = Tokens(tmp_path)
    tokens.revoke(tokens.make("admin"))
    tokens.engine.dispose()
    finished = run("serve", "--port", "0", "--data-dir", str(tmp_path), PRUNUS_REQUIRE_TOKEN="true")
    assert finished.returncode == 1
    assert "PRUNUS_REQUIRE_TOKEN" in finished.stderr


def test_only_open_routes_answer_strangers(guarded: tuple[Server, Tokens]) -> None:
    server, _ = guarded
    with client(server, None) as stranger:
        for path in ("/healthz", "/readyz", "/openapi.json"):
            assert stranger.get(path).status_code == 200
        assert_code(stranger.get("/v1/robots"), 401, "token_required")
        assert_code(stranger.post("/v1/robots/tabletop/stop"), 401, "token_required")
        assert_code(stranger.post("/v1/plans", content=b"x" * 100_000), 401, "token_required")
        assert stranger.get("/v1/robots?token=x").status_code == 401


def test_scopes_and_revocation(guarded: tuple[Server, Tokens], request_body: Body) -> None:
    server, tokens = guarded
    token = tokens.make("plan")
    with client(server, token) as planner:
        answer = planner.post("/v1/plans", json=request_body)
        assert answer.status_code == 201
        assert planner.get(answer.headers["location"]).status_code == 200
        order = {"plan_id": answer.json()["id"], "robot": "tabletop-sim"}
        assert_code(planner.post("/v1/executions", json=order), 403, "insufficient_scope")
        assert_code(planner.post("/v1/robots/tabletop/stop"), 503, "no_worker")
        tokens.revoke(token)
        wait_until(lambda: planner.get("/v1/robots").status_code == 401, WAIT_S)
        assert_code(planner.post("/v1/robots/tabletop/stop"), 401, "invalid_token")


def test_a_worker_joins_with_execute_and_leaves_when_revoked(
    guarded: tuple[Server, Tokens],
) -> None:
    server, tokens = guarded
    for headers, status in (({}, 401), ({"Authorization": f"Bearer {tokens.make('plan')}"}, 403)):
        with (
            pytest.raises(InvalidStatus) as raised,
            connect(link_url(server, "tabletop-sim"), proxy=None, additional_headers=headers),
        ):
            pass
        assert raised.value.response.status_code == status
    token = tokens.make("execute")
    with client(server, token) as joining:
        own = replace(server, client=joining)
        with link(own) as connection:
            fake = FakeWorker(connection)
            fake.say(hello())
            fake.expect(Welcome)
            fake.start()
            tokens.revoke(token)
            assert closed(connection)[0] == REVOKED
            fake.silence()
    with client(server, tokens.make("observe")) as looking:
        wait_until(
            lambda: not looking.get("/v1/robots/tabletop-sim/state").json()["connected"], WAIT_S
        )


def test_a_lease_keeps_others_from_the_arm_but_not_from_stopping_it(
    guarded: tuple[Server, Tokens],
) -> None:
    server, tokens = guarded
    path = "/v1/robots/tabletop-sim/lease"
    plan = make_plan(server)
    with client(server, tokens.make("execute")) as holder, worker(server) as fake:
        assert_code(holder.get(path), 404, "not_found")
        execution = executing(server, fake, plan)
        given = holder.post(path, json={"holder": "row 3", "duration_s": 60})
        assert given.status_code == 201, given.text
        lease = given.json()
        location = f"{path}/{lease['lease_id']}"
        assert given.headers["location"] == location
        told = server.client.get(path).json()
        assert told == {key: lease[key] for key in lease if key != "lease_id"}
        assert lease["lease_id"] not in str(told)
        assert_code(server.client.post(path, json={"holder": "me"}), 409, "leased")

        for name in ("pause", "resume", "cancel"):
            refused = command(server, execution, name)
            assert_code(refused, 409, "leased")
            assert 1 <= int(refused.headers["retry-after"]) <= 60
        assert_code(server.client.post("/v1/robots/tabletop-sim/acknowledge"), 409, "leased")
        assert server.client.post("/v1/robots/tabletop-sim/stop").status_code == 200

        with_lease = {"Prunus-Lease": lease["lease_id"]}
        url = f"/v1/executions/{execution['id']}"
        assert holder.post(f"{url}/pause", headers=with_lease).status_code == 202
        fake.account(execution["id"], "canceled")
        wait_for_status(server, execution, "canceled")
        assert_code(post(server, plan), 409, "leased")
        order = {"plan_id": plan["id"], "robot": "tabletop-sim"}
        started = holder.post("/v1/executions", json=order, headers=with_lease)
        assert started.status_code == 202, started.text

        assert holder.put(location, json={"duration_s": 1}).json()["duration_s"] == 1
        wait_until(lambda: holder.get(path).status_code == 404, WAIT_S)
        # What was started goes on, and is anybody's now.
        assert server.client.get(started.headers["location"]).json()["status"] == "queued"
        assert_code(holder.put(location, json={}), 404, "not_found")
        assert command(server, started.json(), "cancel").status_code == 202
        fake.account(started.json()["id"], "canceled")
        wait_for_status(server, started.json(), "canceled")


def test_leases_are_given_back_and_their_bodies_checked(guarded: tuple[Server, Tokens]) -> None:
    server, _ = guarded
    path = "/v1/robots/tabletop/lease"
    for body, pointer in (
        ({}, "#/holder"),
        ({"holder": ""}, "#/holder"),
        ({"holder": "x" * 101}, "#/holder"),
        ({"holder": "x", "duration_s": 0.5}, "#/duration_s"),
        ({"holder": "x", "duration_s": 301}, "#/duration_s"),
        ({"holder": "x", "duration_s": "30"}, "#/duration_s"),
    ):
        assert_problem(server.client.post(path, json=body), 422, pointer)
    assert_problem(server.client.post("/v1/robots/qq7z/lease", json={"holder": "x"}), 404)
    lease = server.client.post(path, json={"holder": "x"}).json()
    assert lease["duration_s"] == 30
    assert server.client.delete(f"{path}/{lease['lease_id']}").status_code == 204
    assert_problem(server.client.delete(f"{path}/{lease['lease_id']}"), 404)
    assert_problem(server.client.get(path), 404)


def test_pages_of_allowed_origins_ask_first_and_read_the_answer(
    guarded: tuple[Server, Tokens],
) -> None:
    server, _ = guarded
    asking = {
        "Origin": ORIGIN,
        "Access-Control-Request-Method": "POST",
        "Access-Control-Request-Headers": "authorization, content-type, prunus-lease",
    }
    with client(server, None) as page:
        preflight = page.request("OPTIONS", "/v1/plans", headers=asking)
        assert preflight.status_code == 200
        assert preflight.headers["access-control-allow-origin"] == ORIGIN
        assert "access-control-allow-credentials" not in preflight.headers
        # Refusals too can be read by the page.
        refused = page.get("/v1/robots", headers={"Origin": ORIGIN})
        assert refused.status_code == 401
        assert refused.headers["access-control-allow-origin"] == ORIGIN
        for other in ("https://evil.example", f"{ORIGIN}.evil.example", f"{ORIGIN}:8443", "null"):
            stranger = page.request("OPTIONS", "/v1/plans", headers={**asking, "Origin": other})
            assert_code(stranger, 403, "cross_origin")
    answer = server.client.get("/v1/robots", headers={"Origin": ORIGIN})
    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == ORIGIN


def test_pages_of_other_origins_are_off_by_default(server: Server) -> None:
    asking = {"Origin": ORIGIN, "Access-Control-Request-Method": "POST"}
    assert_code(server.client.request("OPTIONS", "/v1/plans", headers=asking), 403, "cross_origin")
    assert "access-control-allow-origin" not in server.client.get("/v1/robots").headers


def test_loopback_needs_no_token_but_takes_no_wrong_one(server: Server) -> None:
    assert server.client.get("/v1/robots").status_code == 200
    wrong = {"Authorization": f"Bearer prunus_{'0' * 12}_{'0' * 64}"}
    assert_code(server.client.get("/v1/robots", headers=wrong), 401, "invalid_token")
    with link(server) as connection:
        connection.send("no hello")
        assert closed(connection)[0] == 4400
    assert state(server)["connected"] is False


def test_limits_of_a_service_that_is_made_small(tmp_path: Path, request_body: Body) -> None:
    """Behind a proxy: tokens on loopback, any name; and no secret in the log of it all."""
    tokens = Tokens(tmp_path)
    token = tokens.make("observe", "plan")
    errors = tmp_path / "errors.txt"
    environment = {
        "PRUNUS_REQUIRE_TOKEN": "true", "PRUNUS_RATE_LIMIT_PER_S": "0.1",
        "PRUNUS_RATE_BURST": "3", "PRUNUS_WORKERS": "1", "PRUNUS_LOG_LEVEL": "debug",
    }  # fmt: skip
    with errors.open("w") as log, running_server(tmp_path, stderr=log, **environment) as server:
        with client(server, None) as stranger:
            proxied = {"Host": "arm.example"}
            assert_code(stranger.get("/v1/robots", headers=proxied), 401, "token_required")
        with client(server, token) as known:
            answers = [known.get("/v1/robots", headers=proxied) for _ in range(5)]
            assert [answer.status_code for answer in answers] == [200, 200, 200, 429, 429]
            assert_code(answers[-1], 429, "rate_limited")
            assert 1 <= int(answers[-1].headers["retry-after"]) <= 10
            for _ in range(5):
                assert_code(known.post("/v1/robots/tabletop/stop"), 503, "no_worker")
                assert known.get("/healthz").status_code == 200
        headers = {"Authorization": f"Bearer {token}"}
        with (
            pytest.raises(InvalidStatus),
            connect(link_url(server, "tabletop"), proxy=None, additional_headers=headers),
        ):
            pass
    tokens.engine.dispose()
    assert token.rpartition("_")[2] not in errors.read_text()


def test_plans_that_wait_are_limited(tmp_path: Path) -> None:
    with running_server(
        tmp_path, PRUNUS_WORKERS="1", PRUNUS_MOST_WAITING_PLANS="1"
    ) as server, ThreadPoolExecutor(6) as pool:  # fmt: skip
        body = {
            "robot": "tabletop",
            "targets": [
                {"id": str(k), "position_m": [0.185, -0.057, 0.42], "branch_direction": [-1, -1, 1]}
                for k in range(100)
            ],
            "options": {"method": "ncos", "order": "independent", "include": []},
        }
        answers = list(pool.map(lambda _: server.client.post("/v1/plans", json=body), range(6)))
        statuses = [answer.status_code for answer in answers]
        assert set(statuses) == {201, 503}
        assert statuses.count(201) >= 2
        for answer in answers:
            if answer.status_code == 503:
                assert_code(answer, 503, "overloaded")
                assert int(answer.headers["retry-after"]) >= 1
        assert server.client.post("/v1/plans", json=body).status_code == 201


def test_the_worker_program_with_and_without_its_token(
    guarded: tuple[Server, Tokens], tmp_path: Path
) -> None:
    server, tokens = guarded
    token_file = tmp_path / "worker.token"
    device = tmp_path / "bus"
    bus_command = [sys.executable, "-m", "app", "servo-bus", "--link", str(device)]
    with subprocess.Popen(bus_command, cwd=REPOSITORY, stdout=subprocess.PIPE, text=True) as bus:
        try:
            assert bus.stdout is not None
            bus.stdout.readline()
            arguments = [
                "worker", "--url", server.url, "--robot", "tabletop-sim", "--port", str(device),
                "--data-dir", str(tmp_path), "--token-file", str(token_file),
            ]  # fmt: skip
            wrong = tokens.make("execute")
            tokens.revoke(wrong)
            token_file.write_text(wrong + "\n")
            refused = run(*arguments)
            assert refused.returncode == 1
            assert "valid token" in refused.stderr
            assert wrong not in refused.stderr

            token_file.write_text(tokens.make("execute") + "\n")
            with subprocess.Popen(
                [sys.executable, "-m", "app", *arguments], cwd=REPOSITORY, stderr=subprocess.DEVNULL
            ) as program:
                wait_until(lambda: bool(state(server)["connected"]), WAIT_S)
                program.terminate()
                assert program.wait(WAIT_S) == 0
        finally:
            bus.terminate()


def test_a_database_password_is_not_told(tmp_path: Path) -> None:
    url = "postgresql+psycopg://prunus:qq7z@127.0.0.1:9/none"
    finished = run(
        "serve", "--host", "0.0.0.0", "--port", "0", PRUNUS_DATABASE_URL=url
    )  # fmt: skip
    assert finished.returncode == 1
    assert "qq7z" not in finished.stderr + finished.stdout
