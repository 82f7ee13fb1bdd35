"""A worker whose link is a script, on simulated servos in time that passes when it sleeps."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import orjson

from hardware.arm.servo_arm import ServoArm
from hardware.clock import RobotClock
from hardware.end_effector.end_effectors import OFF, ON
from hardware.exceptions import EndEffectorFailed
from hardware.link.messages import (
    AcknowledgeReport,
    Execute,
    ExecutionAccount,
    FromService,
    Stop,
    StopReport,
    TargetMotion,
    Telemetry,
)
from hardware.link.worker_end import LinkRefused
from hardware.worker.journal import Journal
from hardware.worker.worker import Worker
from tests.hardware.parts import Bench, make_bench, messages_of, plan_of_data_set_3
from tests.hardware.worker.short_orders import short_messages

LONGEST_RUN_S = 60.0
MOST_LOOKS = 10_000
"""Ticks of the longest scene, twice and more."""


Event = FromService | str | Callable[[], object]


@dataclass
class ScriptedLink:
    """A robot link; `due` says what comes, or is done, at which wall clock instant."""

    bench: Bench
    end_effector: "PlainEndEffector"
    due: deque[tuple[float, Event]] = field(default_factory=deque)
    said: list[Telemetry | ExecutionAccount | StopReport | AcknowledgeReport] = field(
        default_factory=list
    )
    said_at: list[float] = field(default_factory=list)
    is_alive: bool = True
    refusal: LinkRefused | None = None
    looked: int = 0
    worker: Worker | None = None

    def at(self, seconds: float, event: Event) -> None:
        self.due.append((self.bench.time.now_s + seconds, event))

    def next_stop(self) -> Stop | None:
        self._play()
        if self.due and isinstance(self.due[0][1], Stop) and self._is_due():
            message = self.due.popleft()[1]
            assert isinstance(message, Stop)
            return message
        return None

    def next_message(self) -> FromService | None:
        if self.due and self._is_due():
            message = self.due[0][1]
            if not (isinstance(message, Stop | str) or callable(message)):
                self.due.popleft()
                return message
        return None

    def say(self, message: Telemetry | ExecutionAccount | StopReport | AcknowledgeReport) -> None:
        self.said.append(message)
        self.said_at.append(self.bench.time.now_s)

    def close(self) -> None:
        self.is_alive = False

    def _is_due(self) -> bool:
        return self.due[0][0] <= self.bench.time.now_s

    def _play(self) -> None:
        """Words of the script: a fault command, or what happens to link and worker."""
        self.looked += 1
        assert self.looked < MOST_LOOKS, "time does not pass"
        while self.due and self._is_due():
            word = self.due[0][1]
            if not (isinstance(word, str) or callable(word)):
                return
            self.due.popleft()
            if callable(word):
                word()
            elif word == "lose":
                self.is_alive = False
            elif word == "find":
                self.is_alive = True
            elif word == "unplug":
                self.bench.bus.gone = True
            elif word.startswith("sleep "):
                self.bench.time.sleep(float(word.split()[1]))
            elif word.startswith("oversleep "):
                self.bench.time.oversleep_s = float(word.split()[1])
            elif word == "break end-effector":
                self.end_effector.gone = True
            elif word == "end":
                assert self.worker is not None
                self.worker.end()
            else:
                self.bench.fault(word)


@dataclass
class PlainEndEffector:
    state: str = OFF
    broken: bool = False
    gone: bool = False
    beyond_repair: bool = False
    switched: list[str] = field(default_factory=list)

    def switch(self, *, on: bool) -> None:
        self.check()
        if self.broken and on:
            raise EndEffectorFailed("it does not come on")
        self.state = ON if on else OFF
        self.switched.append(self.state)

    def stay_on(self) -> None:
        assert self.state == ON

    def check(self) -> None:
        if self.gone:
            raise EndEffectorFailed("it is gone")

    def recover(self) -> None:
        if self.beyond_repair:
            raise EndEffectorFailed("it is beyond repair")
        self.gone = False
        self.switch(on=False)

    def close(self) -> None:
        self.state = OFF


@dataclass
class Scene:
    bench: Bench
    link: ScriptedLink
    worker: Worker
    end_effector: PlainEndEffector
    journal: Journal
    journal_file: Path

    def order(self, at_s: float = 0.5, execution_id: str = "e1") -> None:
        execute, motions = messages_of(plan_of_data_set_3(), execution_id)
        self.at_once(at_s, (execute, *motions))

    def short_order(self, at_s: float = 0.5, execution_id: str = "e1", targets: int = 2) -> None:
        """One by hand, of less than two seconds for each target."""
        execute, motions = short_messages(self.bench.robot, execution_id, targets)
        self.at_once(at_s, (execute, *motions))

    def at_once(self, at_s: float, messages: Sequence[Execute | TargetMotion]) -> None:
        for message in messages:
            self.link.at(at_s, message)

    def run(self, seconds: float = LONGEST_RUN_S) -> None:
        self.link.at(seconds, "end")
        self.worker.run()

    def accounts(self) -> list[ExecutionAccount]:
        return [said for said in self.link.said if isinstance(said, ExecutionAccount)]

    def telemetry(self) -> list[Telemetry]:
        return [said for said in self.link.said if isinstance(said, Telemetry)]

    def ends(self) -> dict[str, str]:
        """How each execution stands, by its id."""
        return {account.execution_id: account.status for account in self.accounts()}

    def reasons(self) -> dict[str, str]:
        """Why executions did not go well, by their ids."""
        return {one.execution_id: one.error.detail for one in self.accounts() if one.error}

    def journaled(self) -> list[str]:
        """What happened, by the journal on disk."""
        lines = self.journal_file.read_bytes().splitlines()
        return [str(orjson.loads(line)["event"]) for line in lines]

    def spoil_journal(self) -> None:
        """From now on it cannot be written."""
        self.journal_file.unlink()
        self.journal_file.mkdir()

    def state_before(self, kind: type) -> Telemetry:
        """What was said just before the first message of a kind."""
        at = next(k for k, said in enumerate(self.link.said) if isinstance(said, kind))
        state = self.link.said[at - 1]
        assert isinstance(state, Telemetry)
        return state

    def faults(self) -> list[str]:
        """Their codes, as they were told last."""
        return [fault.code for fault in self.telemetry()[-1].faults]

    def acknowledge_reports(self) -> list[AcknowledgeReport]:
        return [said for said in self.link.said if isinstance(said, AcknowledgeReport)]

    def stop_reports(self) -> list[StopReport]:
        return [said for said in self.link.said if isinstance(said, StopReport)]


def make_scene(folder: Path, bench: Bench | None = None, time_factor: float = 1.0) -> Scene:
    bench = bench or make_bench()
    tool = bench.robot.tool(bench.robot.default_tool)
    assert tool is not None
    end_effector = PlainEndEffector()
    link = ScriptedLink(bench, end_effector)
    journal_file = folder / "worker.journal"
    journal = Journal(journal_file)
    clock = RobotClock(time_factor, monotonic=bench.time.monotonic, sleep=bench.time.sleep)
    arm = ServoArm(bench.robot, bench.map, bench.bus, clock)
    worker = Worker(arm, tool, end_effector, link, journal, clock)  # type: ignore[arg-type]
    link.worker = worker
    return Scene(bench, link, worker, end_effector, journal, journal_file)
