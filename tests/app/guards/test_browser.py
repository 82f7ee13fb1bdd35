import asyncio

import httpx2
import pytest
from starlette.types import Message, Receive, Scope, Send
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from app.guards.browser import BrowserGuardMiddleware
from app.settings import is_loopback
from tests.app.conftest import Server, assert_problem
from tests.app.fake_worker import link_url


def port(server: Server) -> str:
    return server.url.rpartition(":")[2]


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "http://127.0.0.1:1",
     "http://127.0.0.1", "file://", "nonsense", "http://[", "http://127.0.0.1:{port}.evil.example"],
)  # fmt: skip
def test_pages_elsewhere_are_refused(server: Server, method: str, origin: str) -> None:
    headers = {"Origin": origin.format(port=port(server))}
    answer = server.client.request(method, "/v1/robots/tabletop/stop", headers=headers)
    problem = assert_problem(answer, 403)
    assert problem["type"].endswith(":cross_origin")
    assert "evil" not in answer.text


def test_own_pages_and_programs_pass(server: Server) -> None:
    for headers in ({}, {"Origin": server.url}, {"Origin": server.url.upper()}):
        assert server.client.get("/v1/robots", headers=headers).status_code == 200


@pytest.mark.parametrize("host", ["evil.example", "evil.example:{port}", "127.0.0.1.evil.example"])
def test_other_names_of_loopback_are_refused(server: Server, host: str) -> None:
    headers = {"Host": host.format(port=port(server))}
    answer = server.client.get("/v1/robots", headers=headers)
    assert assert_problem(answer, 403)["type"].endswith(":unknown_host")
    assert "evil" not in answer.text


@pytest.mark.parametrize("host", ["localhost", "LocalHost:{port}", "[::1]:{port}", "127.0.0.1"])
def test_loopback_names_pass(server: Server, host: str) -> None:
    headers = {"Host": host.format(port=port(server))}
    assert server.client.get("/v1/robots", headers=headers).status_code == 200


def test_websockets_of_pages_are_refused(server: Server) -> None:
    with (
        pytest.raises(InvalidStatus) as raised,
        connect(link_url(server, "tabletop"), origin=Origin("http://evil.example"), proxy=None),
    ):
        pass
    assert raised.value.response.status_code == 403
    state = server.client.get("/v1/robots/tabletop/state").json()
    assert state["connected"] is False


def test_every_route_names_the_refusal(server: Server) -> None:
    document = httpx2.get(f"{server.url}/openapi.json", trust_env=False).json()
    operations = [operation for path in document["paths"].values() for operation in path.values()]
    assert operations
    assert all("403" in operation["responses"] for operation in operations)


def status(listening: str, headers: dict[str, str]) -> int:
    """What a service that listens there answers, 200 where the guard lets it pass."""
    sent: list[Message] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 200})

    async def receive() -> Message:
        return {"type": "http.request"}

    async def send(message: Message) -> None:
        sent.append(message)

    raw = [(name.encode(), value.encode()) for name, value in headers.items()]
    scope: Scope = {"type": "http", "headers": raw, "method": "GET", "path": "/"}
    asyncio.run(BrowserGuardMiddleware(app, host=listening)(scope, receive, send))
    found: int = sent[0]["status"]
    return found


def test_elsewhere_than_on_loopback_any_name_will_do() -> None:
    assert status("0.0.0.0", {"host": "arm.example:8000"}) == 200
    assert status("127.0.0.1", {"host": "arm.example:8000"}) == 403
    assert status("localhost", {}) == 403
    assert status("127.0.0.9", {"host": "127.0.0.9:8000"}) == 200
    same = {"host": "arm.example", "origin": "https://arm.example"}
    assert status("0.0.0.0", same) == 200
    assert status("0.0.0.0", {**same, "origin": "https://arm.example:8443"}) == 403
    assert status("0.0.0.0", {"origin": "https://arm.example"}) == 403


def test_loopback_is_recognised() -> None:
    assert all(map(is_loopback, ["127.0.0.1", "127.1.2.3", "::1", "localhost", "LOCALHOST"]))
    assert not any(map(is_loopback, ["0.0.0.0", "::", "192.168.0.1", "arm.example", ""]))
