"""An order being carried out tick by tick, with what its end-effector did and what was said."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from hardware.end_effector.end_effectors import OFF, ON
from hardware.exceptions import EndEffectorFailed
from hardware.link.messages import ExecutionAccount
from hardware.tolerances import TICK_S
from hardware.worker.execution import Execution
from hardware.worker.order import Order
from solver import Robot, Tool
from tests.hardware.parts import Bench

MOST_TICKS = 4000
"""Of the longest order of the tests, twice."""


@dataclass
class RecordedEndEffector:
    state: str = OFF
    changes: list[tuple[str, str]] = field(default_factory=list)
    accounts: list[ExecutionAccount] = field(default_factory=list)

    def switch(self, *, on: bool) -> None:
        self.state = ON if on else OFF
        self.changes.append((self.accounts[-1].segment or "", self.state))

    def stay_on(self) -> None:
        if self.state != ON:
            raise EndEffectorFailed("it went off")

    def check(self) -> None:
        pass

    def recover(self) -> None:
        self.switch(on=False)

    def close(self) -> None:
        self.state = OFF


@dataclass
class Run:
    bench: Bench
    execution: Execution
    steps: Iterator[None]
    end_effector: RecordedEndEffector
    accounts: list[ExecutionAccount]
    postures: list[list[float]] = field(default_factory=list)
    segments: list[str | None] = field(default_factory=list)

    def tick(self) -> bool:
        """One period of the control loop; False when the order is done."""
        assert len(self.segments) < MOST_TICKS, "it never ends"
        try:
            next(self.steps)
        except StopIteration:
            return False
        self.bench.arm.poll()
        self.bench.time.sleep(TICK_S)
        self.postures.append(self.bench.true_joints())
        self.segments.append(self.execution.account.segment)
        return True

    def until(self, segment: str, ticks: int = 0) -> None:
        while self.execution.account.segment != segment:
            assert self.tick()
        for _ in range(ticks):
            assert self.tick()

    def finish(self) -> None:
        while self.tick():
            pass


def tool_of(robot: Robot) -> Tool:
    tool = robot.tool(robot.default_tool)
    assert tool is not None
    return tool


def make_run(bench: Bench, order: Order) -> Run:
    """An order that is about to begin."""
    bench.arm.check()
    accounts: list[ExecutionAccount] = []
    end_effector = RecordedEndEffector(accounts=accounts)
    execution = Execution(order, bench.arm, tool_of(bench.robot), end_effector, accounts.append)
    return Run(bench, execution, execution.steps(), end_effector, accounts)
