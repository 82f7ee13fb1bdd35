"""A worker without an arm: it joins over the link, and says and reads what a test wants."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, TypeVar

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from hardware.link.messages import (
    Execute,
    ExecutionAccount,
    FromService,
    FromWorker,
    Heartbeat,
    Hello,
    ServoHealth,
    TargetAccount,
    TargetMotion,
    Telemetry,
    Welcome,
    decode_from_service,
    encode,
)
from hardware.servos.instances import load_instance
from tests.app.conftest import Server, wait_until

WAIT_S = 30
ALIVE_S = 0.4
JOINTS = (0.0, 1.5, -1.5, 0.0, 1.5, 0.0)
AT = "2026-01-01T00:00:00.000Z"
SERVO = ServoHealth(11, "joint_1", True, 0.0, -0.25, 12.1, 31, (), 0, AT)
IDLE = Telemetry(
    status="idle",
    torque="on",
    end_effector_state="off",
    faults=(),
    servos=(SERVO,),
    overruns=3,
    joints=JOINTS,
    joints_read_at=AT,
)
MEASURED = TargetAccount("1", "done", (0.1,) * 6, (0.2,) * 6, 0.001, 0.002)
Message = TypeVar("Message")


class FakeWorker:
    """Its telemetry goes out by itself, until it is silenced."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.telemetry = IDLE
        self._silent = threading.Event()
        self._teller = threading.Thread(target=self._tell, daemon=True)

    def start(self) -> None:
        self._teller.start()

    def _tell(self) -> None:
        with contextlib.suppress(ConnectionClosed):
            self.say(self.telemetry)
            while not self._silent.wait(ALIVE_S):
                self.say(self.telemetry)

    def silence(self) -> None:
        self._silent.set()
        if self._teller.ident is not None:
            self._teller.join()

    def say(self, message: FromWorker) -> None:
        self.connection.send(encode(message))

    def next(self) -> FromService:
        """The next message but heartbeats."""
        deadline = time.monotonic() + WAIT_S
        while time.monotonic() < deadline:
            message = decode_from_service(self.connection.recv(timeout=WAIT_S))
            if not isinstance(message, Heartbeat):
                return message
        raise TimeoutError("nothing but heartbeats came")

    def expect(self, kind: type[Message]) -> Message:
        message = self.next()
        assert isinstance(message, kind), message
        return message

    def order(self) -> tuple[Execute, list[TargetMotion]]:
        """An execution with all its motions."""
        execute = self.expect(Execute)
        return execute, [self.expect(TargetMotion) for _ in range(execute.target_count)]

    def account(self, execution_id: str, status: str, **targets: str) -> ExecutionAccount:
        """Say how an execution stands; targets by id and status."""
        told = tuple(TargetAccount(name, state) for name, state in targets.items())
        account = ExecutionAccount(execution_id, status, told)
        self.say(account)
        return account


def hello(robot: str = "tabletop-sim", **changes: Any) -> Hello:
    usual = Hello(
        robot=robot,
        model_version=load_instance(robot).robot.version,
        tool="laser",
        end_effector="simulated",
        device="/dev/none",
        simulated=True,
        calibration_rad=(0.0, 0.01, 0.0, 0.0, 0.0, 0.0),
        version="0",
    )
    return replace(usual, **changes)


def link_url(server: Server, robot: str) -> str:
    return f"{server.url.replace('http', 'ws', 1)}/v1/robots/{robot}/link"


@contextlib.contextmanager
def link(server: Server, robot: str = "tabletop-sim") -> Iterator[ClientConnection]:
    """A connection over which nothing has been said."""
    token = server.client.headers.get("authorization")
    with connect(
        link_url(server, robot),
        proxy=None,
        max_size=None,
        close_timeout=2,
        additional_headers={} if token is None else {"Authorization": token},
    ) as connection:
        yield connection


@contextlib.contextmanager
def worker(server: Server, robot: str = "tabletop-sim", **changes: Any) -> Iterator[FakeWorker]:
    """A worker that has joined."""
    with link(server, robot) as connection:
        fake = FakeWorker(connection)
        fake.say(hello(robot, **changes))
        assert fake.expect(Welcome) == Welcome(robot)
        fake.start()
        wait_for(lambda: state(server, robot).get("telemetry_age_s") is not None)
        try:
            yield fake
        finally:
            fake.silence()
    wait_for(lambda: not state(server, robot)["connected"])


def state(server: Server, robot: str = "tabletop-sim") -> dict[str, Any]:
    found: dict[str, Any] = server.client.get(f"/v1/robots/{robot}/state").json()
    return found


def wait_for(condition: Callable[[], bool]) -> None:
    wait_until(condition, WAIT_S)


def closed(connection: Any) -> tuple[int, str]:
    """The code and reason with which the service closes, whatever it says before."""
    close, deadline = None, time.monotonic() + WAIT_S
    try:
        while time.monotonic() < deadline:
            connection.recv(timeout=WAIT_S)
    except ConnectionClosed as end:
        close = end.rcvd
    assert close is not None, "the service did not close the link"
    return close.code, close.reason
