"""The guard in front of the routes, around an application of the test's own."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError
from starlette.types import Message, Receive, Scope, Send

from app.guards.access import REVOKED, AccessGuardMiddleware
from app.guards.route_scopes import STOP
from app.services.access import service as access_module
from app.services.access.service import TRUSTED_S, AccessService
from app.services.access.tokens import new_token
from app.settings import Settings
from app.store import TokenRow, TokenStore, open_engine

STOP_PATH = "/v1/robots/arm/stop"
PLANS = "/v1/plans"
ROBOTS = "/v1/robots"


class Clock:
    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


class Door:
    """A guarded application that answers 200 and says who came."""

    def __init__(self, store: TokenStore, **options: Any) -> None:
        self.clock = Clock()
        self.store = store
        self.access = AccessService(store, monotonic=self.clock)
        self.clients: list[str] = []
        self.app: Callable[[Scope, Receive, Send], Awaitable[None]] = self.answer
        usual: dict[str, Any] = {
            "token_required": True, "rate_per_s": 1.0, "burst": 1000, "most_requests": 100,
        }  # fmt: skip
        self.guard = AccessGuardMiddleware(
            lambda scope, receive, send: self.app(scope, receive, send),
            access=lambda: self.access,
            **usual | options,
            monotonic=self.clock,
        )

    async def answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.clients.append(scope["state"]["client_id"])
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    async def knock(
        self,
        method: str,
        path: str,
        *authorization: str,
        peer: str = "10.0.0.1",
        incoming: tuple[Message, ...] = (),
    ) -> list[Message]:
        kind = "websocket" if method == "WEBSOCKET" else "http"
        scope: Scope = {
            "type": kind, "path": path, "app": self, "client": (peer, 1),
            "headers": [(b"authorization", value.encode()) for value in authorization],
            "extensions": {"websocket.http.response": {}},
        }  # fmt: skip
        if kind == "http":
            scope["method"] = method
        waiting = list(incoming)
        sent: list[Message] = []

        async def receive() -> Message:
            return waiting.pop(0)

        async def send(message: Message) -> None:
            sent.append(message)

        await self.guard(scope, receive, send)
        return sent

    def status(self, method: str, path: str, *authorization: str, **how: Any) -> int:
        return int(asyncio.run(self.knock(method, path, *authorization, **how))[0]["status"])

    def header(self, name: str, method: str, path: str, *authorization: str, **how: Any) -> str:
        sent = asyncio.run(self.knock(method, path, *authorization, **how))
        return str(dict(sent[0]["headers"])[name.encode()], "ascii")


@pytest.fixture
def store(tmp_path: Path) -> Iterator[TokenStore]:
    engine = open_engine(Settings(data_dir=tmp_path).resolved_database_url)
    yield TokenStore(engine)
    engine.dispose()


def issued(store: TokenStore, *scopes: str) -> tuple[str, TokenRow]:
    token, row = new_token("x", scopes)
    store.add(row)
    return f"Bearer {token}", row


def test_without_a_token_only_open_routes_answer(store: TokenStore) -> None:
    door = Door(store)
    for path in ("/healthz", "/readyz", "/openapi.json", "/docs", "/docs/files/x.js"):
        assert door.status("GET", path) == 200
    for method, path in (("GET", ROBOTS), ("POST", PLANS), ("POST", STOP_PATH), ("GET", "/none")):
        assert door.status(method, path) == 401
        assert door.header("www-authenticate", method, path) == 'Bearer realm="prunus"'


def test_a_token_that_is_none_is_refused_even_where_none_is_needed(store: TokenStore) -> None:
    good, row = issued(store, "admin")
    wrong = good[:-1] + ("0" if good[-1] != "0" else "1")
    for required in (True, False):
        door = Door(store, token_required=required)
        for sent in (
            (wrong,), ("Basic eDp5",), ("",), ("Bearer",), (good, good), (good.split()[1],),
            ("Bearer " + "x" * 10_000,), (good + " more",),
        ):  # fmt: skip
            assert door.status("GET", ROBOTS, *sent) == 401, sent
        assert "invalid_token" in door.header("www-authenticate", "GET", ROBOTS, wrong)
        assert door.status("GET", "/healthz", wrong) == 200
        assert door.status("GET", ROBOTS, good) == 200
        assert door.status("GET", ROBOTS, good.replace("Bearer", "bearer")) == 200
    assert set(door.clients) == {row.id, ""}


def test_on_loopback_nobody_in_particular_may_do_everything(store: TokenStore) -> None:
    door = Door(store, token_required=False)
    assert door.status("POST", "/v1/executions") == 200
    assert door.clients == [""]


@pytest.mark.parametrize("required", [True, False])
def test_scopes_count_wherever_a_token_is_sent(store: TokenStore, required: bool) -> None:
    door = Door(store, token_required=required)
    may = {
        "plan": {PLANS},
        "execute": {"/v1/executions", "/v1/robots/arm/lease", "/v1/robots/arm/acknowledge"},
        "observe": set[str](),
    }
    everything = set.union(*may.values())
    for scope, paths in [*may.items(), ("admin", everything)]:
        token, _ = issued(store, scope)
        for path in everything:
            assert door.status("POST", path, token) == (200 if path in paths else 403), path
        assert door.status("POST", STOP_PATH, token) == 200
        assert door.status("GET", ROBOTS, token) == 200
        assert door.status("GET", "/none", token) == 200
        assert door.status("GET", "/metrics", token) == (
            200 if scope in ("observe", "admin") else 403
        )
    token, _ = issued(store, "observe")
    assert 'scope="plan"' in door.header("www-authenticate", "POST", PLANS, token)


def test_a_revoked_token_is_refused_after_the_second(store: TokenStore) -> None:
    door = Door(store)
    token, row = issued(store, "plan")
    assert door.status("GET", ROBOTS, token) == 200
    store.revoke(row.id)
    door.clock.now_s += TRUSTED_S
    for path in (("GET", ROBOTS), STOP, ("POST", STOP_PATH)):
        assert door.status(*path, token) == 401


class BrokenStore(TokenStore):
    def token(self, token_id: str) -> TokenRow | None:
        raise OperationalError("SELECT", {}, Exception("it is away"))


def test_without_the_store_a_stop_of_a_known_token_passes(store: TokenStore) -> None:
    door = Door(store)
    token, _ = issued(store, "plan")
    stranger, _ = issued(store, "plan")
    assert door.status("GET", ROBOTS, token) == 200
    door.clock.now_s += TRUSTED_S
    door.access._store = BrokenStore.__new__(BrokenStore)
    assert door.status("GET", ROBOTS, token) == 503
    assert door.header("retry-after", "GET", ROBOTS, token) == "1"
    assert door.status("POST", STOP_PATH, token) == 200
    assert door.status("POST", STOP_PATH, stranger) == 503
    assert door.status("GET", "/healthz") == 200


def test_a_stop_does_not_wait_for_a_store_that_hangs(
    store: TokenStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    door = Door(store)
    token, _ = issued(store, "plan")
    assert door.status("POST", STOP_PATH, token) == 200
    door.clock.now_s += TRUSTED_S
    monkeypatch.setattr(access_module, "STOP_PATIENCE_S", 0.01)

    async def hanging(token_id: str, patience_s: float | None) -> None:
        async with asyncio.timeout(patience_s):
            await asyncio.Event().wait()

    monkeypatch.setattr(door.access, "_row", hanging)
    assert door.status("POST", STOP_PATH, token) == 200


def test_too_many_requests_of_a_client(store: TokenStore) -> None:
    door = Door(store, token_required=False, rate_per_s=0.5, burst=3)
    token, _ = issued(store, "observe")
    for sent in ((), (token,)):
        statuses = [door.status("GET", ROBOTS, *sent) for _ in range(5)]
        assert statuses == [200, 200, 200, 429, 429]
    assert door.header("retry-after", "GET", ROBOTS, token) == "2"
    # Others, and what nobody is kept from, go on.
    assert door.status("GET", ROBOTS, peer="10.0.0.2") == 200
    for _ in range(10):
        assert door.status("POST", STOP_PATH, token) == 200
        assert door.status("GET", "/healthz") == 200
    door.clock.now_s += 2
    assert door.status("GET", ROBOTS, token) == 200


def test_tries_of_tokens_are_limited_by_address(store: TokenStore) -> None:
    door = Door(store, burst=3)
    wrong = f"Bearer prunus_{'0' * 12}_{'0' * 64}"
    assert [door.status("GET", ROBOTS, wrong) for _ in range(4)] == [401, 401, 401, 429]
    good, _ = issued(store, "observe")
    assert door.status("GET", ROBOTS, good) == 200, "a token behind the same address pays for it"


def test_requests_at_once_are_limited_but_for_stops(store: TokenStore) -> None:
    door = Door(store, token_required=False, most_requests=2)

    async def crowd() -> list[int]:
        leave = asyncio.Event()

        async def staying(scope: Scope, receive: Receive, send: Send) -> None:
            await leave.wait()
            await door.answer(scope, receive, send)

        door.app = staying
        inside = [asyncio.create_task(door.knock("GET", ROBOTS)) for _ in range(2)]
        await asyncio.sleep(0)
        refused = await door.knock("GET", ROBOTS)
        door.app = door.answer
        stopped = await door.knock("POST", STOP_PATH)
        leave.set()
        answers = [
            refused,
            stopped,
            *await asyncio.gather(*inside),
            await door.knock("GET", ROBOTS),
        ]
        return [int(sent[0]["status"]) for sent in answers]

    assert asyncio.run(crowd()) == [503, 200, 200, 200, 200]


def test_a_websocket_is_refused_with_an_answer(store: TokenStore) -> None:
    door = Door(store)
    for sent, status in (((), 401), ((issued(store, "plan")[0],), 403)):
        (first, *_) = asyncio.run(door.knock("WEBSOCKET", "/v1/robots/arm/link", *sent))
        assert first["type"] == "websocket.http.response.start"
        assert first["status"] == status


async def echo(scope: Scope, receive: Receive, send: Send) -> None:
    while (message := await receive())["type"] == "websocket.receive":
        await send({"type": "websocket.send", "text": message["text"]})
    await send({"type": "websocket.send", "text": "too late"})


def test_a_websocket_of_a_revoked_token_is_closed(store: TokenStore) -> None:
    door = Door(store)
    token, row = issued(store, "execute")

    async def listening(scope: Scope, receive: Receive, send: Send) -> None:
        async def next_message() -> Message:
            message = await receive()
            if message["type"] == "websocket.receive":
                door.clock.now_s += TRUSTED_S
                if message["text"] == "2":
                    store.revoke(row.id)
            return message

        await echo(scope, next_message, send)

    door.app = listening
    messages = tuple({"type": "websocket.receive", "text": text} for text in "123")
    sent = asyncio.run(door.knock("WEBSOCKET", "/v1/robots/arm/link", token, incoming=messages))
    assert [message.get("text") for message in sent[:2]] == ["1", "2"]
    assert sent[2]["type"] == "websocket.close"
    assert sent[2]["code"] == REVOKED
    assert len(sent) == 3


def test_a_store_that_is_away_does_not_close_a_websocket(store: TokenStore) -> None:
    door = Door(store)
    token, _ = issued(store, "execute")

    async def listening(scope: Scope, receive: Receive, send: Send) -> None:
        door.access._store = BrokenStore.__new__(BrokenStore)
        door.clock.now_s += TRUSTED_S
        message = await receive()
        await send({"type": "websocket.send", "text": message["text"]})

    door.app = listening
    sent = asyncio.run(
        door.knock(
            "WEBSOCKET", "/v1/robots/arm/link", token,
            incoming=({"type": "websocket.receive", "text": "1"},),
        )
    )  # fmt: skip
    assert sent == [{"type": "websocket.send", "text": "1"}]


def test_a_stream_of_a_revoked_token_is_cut(store: TokenStore) -> None:
    door = Door(store)
    token, row = issued(store, "observe")

    async def streaming(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        for number in range(5):
            if number == 2:
                store.revoke(row.id)
            door.clock.now_s += TRUSTED_S
            await send({"type": "http.response.body", "body": b"x", "more_body": True})
        await send({"type": "http.response.body", "body": b""})

    door.app = streaming
    sent = asyncio.run(door.knock("GET", "/v1/jobs/x/events", token))
    assert [message.get("body") for message in sent] == [None, b"x", b"x"]
