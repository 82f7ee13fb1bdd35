"""Clients that never give up: every request has a key and is repeated until it is answered."""

import random
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

import httpx2
import orjson

from app.routers.idempotency_key import HEADER, REPLAYED
from app.schemas.demo_request import demo_request

ROBOT: Final = "tabletop-sim"
ACTIVE: Final = ("queued", "executing", "paused")
PAUSE_S = 0.05
ANSWER_S = 60.0
GIVE_UP_S = 900.0
SPREAD_M = 0.02
BATCH_TARGETS = (1, 1, 1, 5, 20)
LONGEST_PAUSE_S = 0.2
JOB_TARGETS = (60, 400, 1500)


@dataclass(frozen=True)
class Answered:
    """A request with the answer it got in the end.

    Attributes:
        kind: what it created: plan, job or execution.
        attempts: how often it was sent.
        replayed: the answer is that to an attempt whose answer was lost.
    """

    kind: str
    path: str
    key: str
    body: bytes
    targets: int
    status: int
    location: str
    content: bytes
    attempts: int
    replayed: bool


@dataclass
class Account:
    """What the clients were answered; written by several threads."""

    answered: list[Answered] = field(default_factory=list)
    unexpected: list[str] = field(default_factory=list)


class GivenUp(Exception):
    """A request had no answer, or one that nobody should get."""


class NeverGivingUp:
    """Sends over the service's deaths."""

    def __init__(self, url: str) -> None:
        self._client = httpx2.Client(base_url=url, timeout=ANSWER_S, trust_env=False)

    def send(
        self, method: str, path: str, content: bytes | None = None, **headers: str
    ) -> tuple[httpx2.Response, int]:
        """The answer that is neither lost nor "later", and how often it was asked for."""
        deadline, attempts = time.monotonic() + GIVE_UP_S, 0
        while time.monotonic() < deadline:
            attempts += 1
            try:
                answer = self._client.request(
                    method,
                    path,
                    content=content,
                    headers={k.replace("_", "-"): v for k, v in headers.items()},
                )
            except httpx2.TransportError:
                time.sleep(PAUSE_S)
                continue
            if answer.status_code not in (429, 503):
                return answer, attempts
            time.sleep(PAUSE_S)
        raise GivenUp(f"{method} {path} had no answer in {GIVE_UP_S:g} s")

    def close(self) -> None:
        """Give its connections back."""
        self._client.close()


class LoadClient(threading.Thread):
    """Posts one thing after the other until told to stop; what it began it brings to an answer."""

    def __init__(
        self, name: str, url: str, seed: int, account: Account, stopping: threading.Event
    ) -> None:
        super().__init__(name=name, daemon=True)
        self._service = NeverGivingUp(url)
        self._random = random.Random(f"{seed} {name}")
        self._account = account
        self._stopping = stopping

    def run(self) -> None:
        """Until it is told to stop."""
        try:
            while not self._stopping.is_set():
                self._one()
        except Exception as error:  # a thread that dies silently would look like success
            self._account.unexpected.append(f"{self.name}: {type(error).__name__}: {error}")
        finally:
            self._service.close()

    def _one(self) -> None:
        self._plan(self._random.choice(BATCH_TARGETS))
        # Without pauses nothing is left for jobs, which take what the others leave.
        time.sleep(self._random.uniform(0, LONGEST_PAUSE_S))

    def _plan(self, targets: int, **headers: str) -> Answered:
        body = orjson.dumps(self._request(targets))
        return self._create("/v1/plans", body, targets, lambda _: None, **headers)

    def _request(self, targets: int) -> dict[str, Any]:
        request = demo_request()
        several = []
        for number in range(targets):
            target = request["targets"][number % len(request["targets"])]
            position = [x + self._random.uniform(-SPREAD_M, SPREAD_M) for x in target["position_m"]]
            several.append({**target, "id": str(number), "position_m": position})
        options = {"method": "ssas", "dwell_s": 0.2}
        return {**request, "targets": several, "options": options}

    def _create(
        self,
        path: str,
        body: bytes,
        targets: int,
        conflict: Callable[[httpx2.Response], None],
        **headers: str,
    ) -> Answered:
        key, attempts = f"{self._random.getrandbits(128):032x}", 0
        deadline = time.monotonic() + GIVE_UP_S
        while True:
            answer, tried = self._service.send(
                "POST", path, body, **{HEADER: key, "Content-Type": "application/json", **headers}
            )
            attempts += tried
            if answer.status_code != 409 or time.monotonic() > deadline:
                break
            conflict(answer)
        if answer.status_code not in (201, 202):
            raise GivenUp(f"POST {path} was answered {answer.status_code}: {answer.text[:300]}")
        location = answer.headers["location"]
        answered = Answered(
            location.split("/")[2].removesuffix("s"), path, key, body, targets,
            answer.status_code, location, answer.content, attempts, REPLAYED in answer.headers,
        )  # fmt: skip
        self._account.answered.append(answered)
        return answered


class JobClient(LoadClient):
    """Posts batches that are to be jobs."""

    def _one(self) -> None:
        answered = self._plan(self._random.choice(JOB_TARGETS), Prefer="respond-async")
        if answered.kind == "job":
            # One at a time, so that jobs are interrupted rather than only queued.
            while self._service.send("GET", answered.location)[0].json()["status"] in (
                "queued",
                "running",
            ):
                time.sleep(PAUSE_S)


class ExecutionClient(LoadClient):
    """Has plans of one target executed by the worker, and acknowledges what the deaths did."""

    def _one(self) -> None:
        plan = orjson.loads(self._plan(1).content)
        if plan["summary"]["planned"] == 0:
            return
        order = orjson.dumps({"plan_id": plan["id"], "robot": ROBOT})
        execution = self._create("/v1/executions", order, 1, self._mend)
        while self._service.send("GET", execution.location)[0].json()["status"] in ACTIVE:
            time.sleep(PAUSE_S)

    def _mend(self, refused: httpx2.Response) -> None:
        # The arm stood still when the service died; nobody is near it.
        if refused.json()["type"].endswith(":fault"):
            self._service.send("POST", f"/v1/robots/{ROBOT}/acknowledge")
        time.sleep(PAUSE_S)
