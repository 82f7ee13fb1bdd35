"""Who is connected: one link a robot, what its worker said last, and questions put to it."""

import asyncio
import time
import uuid
from collections.abc import Callable
from typing import Final

from anyio import to_thread

from app.services.robots.outbox import Outbox
from hardware.link.messages import (
    Acknowledge,
    AcknowledgeReport,
    Hello,
    Stop,
    StopReport,
    Telemetry,
)
from hardware.servos.instances import RobotInstance, load_instance
from solver import UnknownRobot

ANSWER_S: Final = 3.0
"""How long a stop or an acknowledgement waits for the worker's answer."""

# Close codes of the link, of those that are left to applications.
NOT_A_MESSAGE: Final = 4400
UNKNOWN_ROBOT: Final = 4404
SILENT: Final = 4408
HAS_A_WORKER: Final = 4409
WRONG_WORKER: Final = 4412

Answer = StopReport | AcknowledgeReport


class LinkRefused(Exception):
    """A worker that may not join: a close code and one sentence."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        self.reason = reason


class Link:
    """A worker that has joined.

    Attributes:
        robot: the robot's name.
        hello: how the worker introduced itself.
        outbox: what is to be sent to it.
        telemetry: what it said last, if anything.
    """

    def __init__(self, robot: str, hello: Hello) -> None:
        self.robot = robot
        self.hello = hello
        self.outbox = Outbox()
        self.telemetry: Telemetry | None = None
        self._telemetry_at = 0.0
        self._questions: dict[str, asyncio.Future[Answer | None]] = {}

    @property
    def telemetry_age_s(self) -> float:
        """How long ago the telemetry came."""
        return time.monotonic() - self._telemetry_at

    def take_telemetry(self, telemetry: Telemetry) -> None:
        """Keep it as the last."""
        self.telemetry = telemetry
        self._telemetry_at = time.monotonic()

    def take_answer(self, answer: Answer) -> None:
        """Hand it to whoever asked; nobody may any more."""
        question = self._questions.get(answer.request_id)
        if question is not None and not question.done():
            question.set_result(answer)

    async def ask(self, question: Callable[[str], Stop | Acknowledge]) -> Answer | None:
        """Send a question at once; the worker's answer, or None if none comes in time."""
        request_id = uuid.uuid4().hex
        future: asyncio.Future[Answer | None] = asyncio.get_running_loop().create_future()
        self._questions[request_id] = future
        self.outbox.send(question(request_id))
        try:
            async with asyncio.timeout(ANSWER_S):
                return await future
        except TimeoutError:
            return None
        finally:
            del self._questions[request_id]

    def close(self) -> None:
        """Nobody answers any more."""
        for question in self._questions.values():
            if not question.done():
                question.set_result(None)


class LinkService:
    """The links by robot. It lives on the event loop and is used there only."""

    def __init__(self) -> None:
        self._links: dict[str, Link] = {}

    def get(self, robot: str) -> Link | None:
        """The robot's link, if a worker is connected."""
        return self._links.get(robot)

    @property
    def count(self) -> int:
        """How many robots have a worker connected."""
        return len(self._links)

    async def instance(self, robot: str) -> RobotInstance:
        """The robot that a worker wants to join.

        Raises:
            LinkRefused: there is none of that name.
        """
        try:
            return await to_thread.run_sync(load_instance, robot)
        except UnknownRobot:
            raise LinkRefused(UNKNOWN_ROBOT, "There is no robot of this name.") from None

    def join(self, instance: RobotInstance, hello: Hello) -> Link:
        """The link of a worker that may join.

        Raises:
            LinkRefused: it may not.
        """
        robot = instance.robot
        if hello.robot != robot.name:
            raise LinkRefused(NOT_A_MESSAGE, "The hello names another robot than the address.")
        if len(hello.calibration_rad) != len(robot.joints):
            raise LinkRefused(NOT_A_MESSAGE, "The calibration needs one offset for each joint.")
        if hello.model_version != robot.version:
            raise LinkRefused(WRONG_WORKER, "The worker has another version of the robot's model.")
        if instance.simulated and not hello.simulated:
            raise LinkRefused(WRONG_WORKER, "Only simulated servos may stand behind this robot.")
        if robot.name in self._links:
            raise LinkRefused(HAS_A_WORKER, "This robot has a worker already.")
        link = self._links[robot.name] = Link(robot.name, hello)
        return link

    def leave(self, link: Link) -> None:
        """The link has ended."""
        if self._links.get(link.robot) is link:
            del self._links[link.robot]
        link.close()
