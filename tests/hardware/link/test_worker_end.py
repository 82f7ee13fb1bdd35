"""The worker's end of the robot link, against a small server of the test's own."""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve

from hardware.link.messages import (
    AcknowledgeReport,
    Cancel,
    ExecutionAccount,
    Heartbeat,
    Hello,
    InvalidMessage,
    Pause,
    Stop,
    StopReport,
    Telemetry,
    Welcome,
    decode_from_service,
    decode_from_worker,
    encode,
)
from hardware.link.worker_end import LinkRefused, RobotLink, link_url
from tests.app.conftest import wait_until

HELLO = Hello("tabletop", "v", "laser", "none", "/dev/null", True, (0.0,) * 6, "0")
IDLE = Telemetry("idle", "off", "none", (), (), 0)
Talk = Callable[[ServerConnection], None]
WAIT_S = 20
Message = TypeVar("Message")


@contextmanager
def serving(talk: Talk) -> Iterator[str]:
    """A service that takes the hello and then does what `talk` says with the connection."""

    def handle(connection: ServerConnection) -> None:
        try:
            assert decode_from_worker(connection.recv()) == HELLO
            talk(connection)
        except ConnectionClosed:
            return

    with serve(handle, "127.0.0.1", 0, close_timeout=1) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.socket.getsockname()[1]}"
        finally:
            server.shutdown()
            thread.join()


@contextmanager
def joined(url: str) -> Iterator[tuple[RobotLink, list[str]]]:
    news: list[str] = []
    link = RobotLink(link_url(url, "tabletop"), HELLO, news.append)
    try:
        yield link, news
    finally:
        link.close()


def first(take: Callable[[], Message | None]) -> Message:
    """The first message that comes."""
    deadline = time.monotonic() + WAIT_S
    while (message := take()) is None:
        assert time.monotonic() < deadline, "nothing came"
        time.sleep(0.01)
    return message


def heartbeats(connection: ServerConnection) -> None:
    while True:
        connection.send(encode(Heartbeat()))
        time.sleep(0.1)


def test_urls_of_links() -> None:
    assert link_url("http://orchard:8000", "a") == "ws://orchard:8000/v1/robots/a/link"
    assert link_url("https://orchard/prunus/", "a/b ü") == (
        "wss://orchard/prunus/v1/robots/a%2Fb%20%C3%BC/link"
    )
    for wrong in (
        "orchard:8000",
        "ftp://orchard",
        "",
        "http://",
        "http://[::1",
        "http://orchard:99999",
        "http://orchard:0",
        f"http://{'a' * 64}",
    ):
        with pytest.raises(LinkRefused):
            link_url(wrong, "a")


def test_it_joins_stays_alive_and_notices_silence() -> None:
    silent, over = threading.Event(), threading.Event()

    def talk(connection: ServerConnection) -> None:
        connection.send(encode(Welcome("tabletop")))
        while not silent.is_set():
            connection.send(encode(Heartbeat()))
            time.sleep(0.1)
        over.wait(WAIT_S)

    with serving(talk) as url, joined(url) as (link, news):
        assert not link.is_alive
        wait_until(lambda: link.is_alive, WAIT_S)
        assert news == [f"joined {link_url(url, 'tabletop')}"]
        time.sleep(2.5)
        assert link.is_alive
        silent.set()
        wait_until(lambda: not link.is_alive, WAIT_S)
        over.set()


def test_stops_go_ahead_of_what_came_before_them() -> None:
    def talk(connection: ServerConnection) -> None:
        for message in (Welcome("tabletop"), Pause("e1"), Cancel("e1"), Stop("s1")):
            connection.send(encode(message))
        heartbeats(connection)

    with serving(talk) as url, joined(url) as (link, _):
        assert first(link.next_stop) == Stop("s1")
        assert [link.next_message(), link.next_message()] == [Pause("e1"), Cancel("e1")]
        assert link.next_message() is None


def test_only_the_newest_telemetry_and_account_are_said_and_every_report() -> None:
    heard: list[object] = []
    begun = threading.Event()

    def talk(connection: ServerConnection) -> None:
        begun.wait(WAIT_S)
        connection.send(encode(Welcome("tabletop")))
        while True:
            connection.send(encode(Heartbeat()))
            heard.append(decode_from_worker(connection.recv()))

    reports: list[StopReport | AcknowledgeReport] = [
        StopReport("s1", False, False, ""),
        AcknowledgeReport("a1", ()),
    ]
    accounts = [ExecutionAccount("e1", status, ()) for status in ("executing", "paused")]
    with serving(talk) as url, joined(url) as (link, _):
        for telemetry in (IDLE, IDLE):
            link.say(telemetry)
        for account in accounts:
            link.say(account)
        for report in reports:
            link.say(report)
        begun.set()
        wait_until(lambda: len(heard) >= 4, WAIT_S)
        assert heard == [IDLE, accounts[-1], *reports]


def test_the_last_account_is_said_again_after_a_loss() -> None:
    heard: list[object] = []

    def talk(connection: ServerConnection) -> None:
        connection.send(encode(Welcome("tabletop")))
        heard.append(decode_from_worker(connection.recv()))
        connection.close()

    account = ExecutionAccount("e1", "failed", ())
    with serving(talk) as url, joined(url) as (link, _):
        link.say(account)
        wait_until(lambda: len(heard) >= 2, WAIT_S)
    assert heard[:2] == [account, account]


def test_what_came_before_a_loss_is_not_obeyed_after_it() -> None:
    connections: list[ServerConnection] = []

    def talk(connection: ServerConnection) -> None:
        connections.append(connection)
        connection.send(encode(Welcome("tabletop")))
        if len(connections) == 1:
            connection.send(encode(Pause("old")))
            connection.close()
            return
        connection.send(encode(Pause("new")))
        heartbeats(connection)

    with serving(talk) as url, joined(url) as (link, _):
        wait_until(lambda: len(connections) == 2 and link.is_alive, WAIT_S)
        assert first(link.next_message) == Pause("new")


@pytest.mark.parametrize(
    ("code", "final"), [(4401, True), (4404, True), (4412, True), (4409, False)]
)
def test_some_refusals_are_final(code: int, final: bool) -> None:
    asked: list[int] = []

    def talk(connection: ServerConnection) -> None:
        asked.append(code)
        connection.close(code, "because")

    with serving(talk) as url, joined(url) as (link, news):
        if final:
            wait_until(lambda: link.refusal is not None, WAIT_S)
            assert "because" in str(link.refusal)
        else:
            wait_until(lambda: len(asked) >= 2, WAIT_S)
            assert link.refusal is None
        # The same news is told once, however often it comes.
        assert news == ["the link was closed: because"]


def test_a_service_that_is_not_there_is_tried_again() -> None:
    with joined("http://127.0.0.1:9") as (link, news):
        wait_until(lambda: bool(news), WAIT_S)
        assert "no link" in news[0]
        assert link.refusal is None
        assert not link.is_alive


def test_something_else_than_messages_closes_the_link() -> None:
    asked: list[str] = []

    def talk(connection: ServerConnection) -> None:
        asked.append("")
        connection.send(encode(Welcome("tabletop")))
        connection.send('{"type": "dance"}')
        heartbeats(connection)

    with serving(talk) as url, joined(url) as (link, news):
        wait_until(lambda: len(asked) >= 2, WAIT_S)
        assert news
        assert link.refusal is None


@pytest.mark.parametrize(
    "text",
    [
        "",
        "null",
        "[]",
        '{"type": "stop"}',
        '{"type": "stop", "request_id": 1}',
        '{"type": "stop", "request_id": "a", "more": 1}',
        '{"type": "hello"}',
    ],
)
def test_texts_that_are_no_messages_of_the_service(text: str) -> None:
    with pytest.raises(InvalidMessage):
        decode_from_service(text)


def test_numbers_that_are_none_are_no_message() -> None:
    spoiled = encode(IDLE).replace('"joints":null', '"joints":[NaN]')
    assert spoiled != encode(IDLE)
    with pytest.raises(InvalidMessage):
        decode_from_worker(spoiled)


@pytest.mark.parametrize("status", [401, 403])
def test_a_token_that_is_not_accepted_is_final_and_not_told(
    status: int, caplog: pytest.LogCaptureFixture
) -> None:
    asked: list[str | None] = []

    def refuse(connection: ServerConnection, request: Request) -> Response:
        asked.append(request.headers.get("Authorization"))
        return connection.respond(status, "no")

    news: list[str] = []
    with (
        caplog.at_level(logging.DEBUG),
        serve(lambda _: None, "127.0.0.1", 0, process_request=refuse) as server,
    ):
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        url = f"http://127.0.0.1:{server.socket.getsockname()[1]}"
        caplog.clear()
        link = RobotLink(link_url(url, "tabletop"), HELLO, news.append, "qq7z")
        try:
            wait_until(lambda: link.refusal is not None, WAIT_S)
        finally:
            link.close()
            server.shutdown()
            thread.join()
    assert asked == ["Bearer qq7z"]
    assert str(status) in str(link.refusal)
    assert "token" in str(link.refusal)
    assert news == [str(link.refusal)]
    told = [r.getMessage() for r in caplog.records if not r.name.startswith("websockets.server")]
    assert "qq7z" not in "".join([*news, *told])
