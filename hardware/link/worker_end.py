"""The worker's end of the robot link: joins, joins again, and never makes the control loop wait.

A thread owns the WebSocket. What is to be said is kept as the newest telemetry, the newest account
and the reports not yet sent, so nothing piles up while the service is away.
"""

import contextlib
import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final
from urllib.parse import quote, urlsplit, urlunsplit

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus, InvalidURI
from websockets.sync.client import ClientConnection, connect

from hardware.exceptions import HardwareError
from hardware.link.messages import (
    SILENCE_S,
    AcknowledgeReport,
    ExecutionAccount,
    FromService,
    Heartbeat,
    Hello,
    InvalidMessage,
    Stop,
    StopReport,
    Telemetry,
    Welcome,
    decode_from_service,
    encode,
)
from hardware.tolerances import LINK_POLL_S, RECONNECT_S

# Close codes with which the service refuses for good; see docs/errors.md.
FINAL_CODES: Final = (4401, 4404, 4412)
# The same as answers to the handshake: trying again with the same token would not help.
FINAL_STATUSES: Final = {
    401: "the service wants a valid token",
    403: "the service does not allow this token, or this address of it",
}
MOST_BYTES: Final = 64 * 1024 * 1024


class LinkRefused(HardwareError):
    """The service will not have this worker."""

    code = "link_refused"


def link_url(service_url: str, robot: str) -> str:
    """The robot link's address below a service's http or https address.

    Raises:
        LinkRefused: not such an address.
    """
    try:
        parts = urlsplit(service_url)
        scheme = {"http": "ws", "https": "wss"}.get(parts.scheme)
        usable = scheme is not None and bool(parts.hostname) and (parts.port is None or parts.port)
        (parts.hostname or "").encode("idna")
    except ValueError:
        usable = False
    if not usable or scheme is None:
        raise LinkRefused(f"{service_url} is not the http or https address of a service")
    path = f"{parts.path.rstrip('/')}/v1/robots/{quote(robot, safe='')}/link"
    return urlunsplit((scheme, parts.netloc, path, "", ""))


class RobotLink:
    """A link that is kept up until it is closed.

    Args:
        url: see `link_url`.
        hello: what is said first.
        on_news: called with a sentence whenever the link comes, goes, or is refused.
        token: the service's; empty: none.
    """

    def __init__(
        self, url: str, hello: Hello, on_news: Callable[[str], None], token: str = ""
    ) -> None:
        self._url = url
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}
        # The library writes every header to its log at debug level, so this one has none.
        self._logger = logging.getLogger(f"{__name__}.websocket")
        self._logger.setLevel(logging.INFO)
        self._hello = hello
        self._on_news = on_news
        self._lock = threading.Lock()
        self._telemetry: Telemetry | None = None
        self._account: ExecutionAccount | None = None
        self._account_pending = False
        self._reports: deque[StopReport | AcknowledgeReport] = deque()
        self._inbox: deque[FromService] = deque()
        self._stops: deque[Stop] = deque()
        self._heard = -float("inf")
        self._closing = threading.Event()
        self._news = ""
        self.refusal: LinkRefused | None = None
        self._thread = threading.Thread(target=self._run, name="robot-link", daemon=True)
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether the service was heard within SILENCE_S, on a clock that never steps."""
        return time.monotonic() - self._heard < SILENCE_S

    def next_stop(self) -> Stop | None:
        """The next stop, ahead of everything else that came."""
        with self._lock:
            return self._stops.popleft() if self._stops else None

    def next_message(self) -> FromService | None:
        """The next other message."""
        with self._lock:
            return self._inbox.popleft() if self._inbox else None

    def say(self, message: Telemetry | ExecutionAccount | StopReport | AcknowledgeReport) -> None:
        """Have a message sent when the link allows; a newer telemetry or account replaces it."""
        with self._lock:
            match message:
                case Telemetry():
                    self._telemetry = message
                case ExecutionAccount():
                    self._account, self._account_pending = message, True
                case _:
                    self._reports.append(message)

    def close(self) -> None:
        """Say what is left to say, and leave."""
        self._closing.set()
        self._thread.join(SILENCE_S)

    def _run(self) -> None:
        while not self._closing.is_set():
            try:
                with connect(
                    self._url,
                    open_timeout=SILENCE_S,
                    close_timeout=SILENCE_S,
                    ping_interval=None,
                    max_size=MOST_BYTES,
                    proxy=None,
                    additional_headers=self._headers,
                    logger=self._logger,
                ) as connection:
                    self._join(connection)
                    self._talk(connection)
            except ConnectionClosed as error:
                closed = error.rcvd
                self._tell(f"the link was closed: {closed.reason if closed else 'without a word'}")
                if closed is not None and closed.code in FINAL_CODES:
                    self.refusal = LinkRefused(f"the service refuses: {closed.reason}")
                    return
            except InvalidStatus as error:
                status = error.response.status_code
                if status in FINAL_STATUSES:
                    self.refusal = LinkRefused(f"{FINAL_STATUSES[status]} (status {status})")
                    self._tell(str(self.refusal))
                    return
                self._tell(f"no link to {self._url}: {error}")
            except (OSError, TimeoutError, InvalidHandshake, InvalidMessage) as error:
                self._tell(f"no link to {self._url}: {error}")
            except InvalidURI as error:
                self.refusal = LinkRefused(str(error))
                return
            finally:
                self._heard = -float("inf")
            self._closing.wait(RECONNECT_S)

    def _join(self, connection: ClientConnection) -> None:
        connection.send(encode(self._hello))
        answer = decode_from_service(connection.recv(SILENCE_S))
        if not isinstance(answer, Welcome):
            raise InvalidMessage(f"expected a welcome, not {answer.type}")
        with self._lock:
            self._inbox.clear()
            self._stops.clear()
            # The service may have been away, or be another one, when it was said before.
            self._account_pending = self._account is not None
        self._heard = time.monotonic()
        self._tell(f"joined {self._url}")

    def _talk(self, connection: ClientConnection) -> None:
        while not self._closing.is_set():
            with contextlib.suppress(TimeoutError):
                self._take(decode_from_service(connection.recv(LINK_POLL_S)))
            if not self.is_alive:
                raise TimeoutError("the service fell silent")
            self._flush(connection)
        self._flush(connection)

    def _take(self, message: FromService) -> None:
        self._heard = time.monotonic()
        if isinstance(message, Heartbeat):
            return
        with self._lock:
            if isinstance(message, Stop):
                self._stops.append(message)
            else:
                self._inbox.append(message)

    def _flush(self, connection: ClientConnection) -> None:
        with self._lock:
            pending = [*self._reports]
            self._reports.clear()
            account = self._account if self._account_pending else None
            self._account_pending = False
            telemetry, self._telemetry = self._telemetry, None
        # State first: whoever hears that a fault was cleared may act on it at once.
        for message in (telemetry, account, *pending):
            if message is not None:
                connection.send(encode(message))

    def _tell(self, news: str) -> None:
        if news != self._news:
            self._news = news
            self._on_news(news)
