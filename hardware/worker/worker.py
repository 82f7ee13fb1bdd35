"""The worker: one loop that owns the arm, takes orders from the link, and accounts for them.

    idle ◄─► executing ◄─► paused
     ▲           │            │
     └─ acknowledge ── fault ◄┘

A fault holds the arm, switches the end-effector off, ends what runs, and stays until somebody
acknowledges it and the servos check out.
"""

import logging
import threading
from collections.abc import Callable, Iterator
from typing import Final

from hardware.arm.servo_arm import ServoArm
from hardware.clock import RobotClock, timestamp
from hardware.end_effector.end_effectors import EndEffector
from hardware.exceptions import (
    BusLost,
    Canceled,
    HardwareError,
    InternalError,
    Interrupted,
    JournalFailed,
    LinkLost,
    OrderRefused,
    PortUnavailable,
    Stopped,
    WorkerEnded,
)
from hardware.link.messages import (
    CANCELED,
    ENDED,
    FAILED,
    SILENCE_S,
    Acknowledge,
    AcknowledgeReport,
    Cancel,
    Execute,
    ExecutionAccount,
    Failure,
    Pause,
    Resume,
    Stop,
    StopReport,
    TargetMotion,
)
from hardware.link.worker_end import RobotLink
from hardware.tolerances import IDLE_TICK_S, TELEMETRY_S, TICK_S
from hardware.worker.execution import Execution
from hardware.worker.fault_latch import FaultLatch
from hardware.worker.journal import Journal
from hardware.worker.order import build_order
from hardware.worker.safe_state import make_safe, stop_report
from hardware.worker.telemetry import telemetry
from solver import Tool

logger = logging.getLogger(__name__)

ALL_DONE: Final = object()


class Worker:
    """Drives one arm until it is told to end.

    Args:
        arm: the servos.
        tool: what is mounted.
        end_effector: what is on during a dwell.
        link: to the service.
        journal: of executions started.
        clock: robot time.
    """

    def __init__(
        self,
        arm: ServoArm,
        tool: Tool,
        end_effector: EndEffector,
        link: RobotLink,
        journal: Journal,
        clock: RobotClock,
    ) -> None:
        self._arm = arm
        self._tool = tool
        self._end_effector = end_effector
        self._link = link
        self._journal = journal
        self._clock = clock
        self._faults = FaultLatch()
        self._incoming: tuple[Execute, list[TargetMotion]] | None = None
        self._execution: Execution | None = None
        self._steps: Iterator[None] = iter(())
        self._overruns = 0
        self._telemetry_due = clock.now()
        self._ending = threading.Event()

    def end(self) -> None:
        """Have `run` return; safe from a signal handler or another thread."""
        self._ending.set()

    def run(self) -> None:
        """Work until `end`; the arm holds then, the end-effector is off.

        Raises:
            LinkRefused: the service will not have this worker.
        """
        self._look_around()
        due = self._clock.now()
        while not self._ending.is_set() and self._link.refusal is None:
            self._take_stops()
            self._take_messages()
            self._advance()
            self._say_telemetry()
            due += IDLE_TICK_S if self._execution is None else TICK_S
            now = self._clock.now()
            if now > due:
                self._catch_up(now - due)
                due = now
            self._clock.sleep(due - now)
            if (late := self._clock.now() - due) > SILENCE_S * self._clock.factor:
                self._catch_up(late)
                due += late
        if self._execution is not None:
            self._fail(WorkerEnded("the worker was told to end"))
        self._say_telemetry(now_due=True)
        self._link.close()
        if self._link.refusal is not None:
            raise self._link.refusal

    def _catch_up(self, late_s: float) -> None:
        """A tick came late: the motion waited, as its time only passes tick by tick."""
        if self._execution is not None:
            self._overruns += 1
            if late_s > SILENCE_S * self._clock.factor:
                # Whatever the link has heard since, the service has given this worker up.
                self._fail(LinkLost(f"the worker itself stood still for {late_s:.1f} s"))

    # --- What comes over the link -----------------------------------------------------------------
    def _take_stops(self) -> None:
        while (stop := self._link.next_stop()) is not None:
            report = self._stop(stop)
            self._say_telemetry(now_due=True)
            self._link.say(report)

    def _take_messages(self) -> None:
        while (message := self._link.next_message()) is not None:
            match message:
                case Execute():
                    self._incoming = (message, [])
                case TargetMotion() if self._incoming is not None:
                    self._incoming[1].append(message)
                case Acknowledge():
                    self._acknowledge(message)
                case Pause() | Resume() | Cancel():
                    self._steer(message)
            if self._incoming is not None:
                execute, motions = self._incoming
                if len(motions) >= execute.target_count:
                    self._incoming = None
                    self._begin(execute, motions)

    def _steer(self, message: Pause | Resume | Cancel) -> None:
        execution = self._execution
        incoming = self._incoming
        if incoming and incoming[0].execution_id == message.execution_id:
            if isinstance(message, Cancel):
                self._refuse_incoming(Canceled("canceled before it began"))
            return
        if execution is None or execution.account.execution_id != message.execution_id:
            return
        match message:
            case Pause():
                execution.pause()
            case Resume():
                execution.resume()
            case Cancel():
                execution.cancel()

    def _begin(self, execute: Execute, motions: list[TargetMotion]) -> None:
        try:
            if self._execution is not None:
                raise OrderRefused("another execution is under way")
            if self._faults:
                raise OrderRefused(f"faults to acknowledge: {', '.join(self._faults.codes)}")
            order = build_order(self._arm.robot, self._tool, self._arm.map, execute, motions)
            self._journal.start(order.execution_id)
        except HardwareError as error:
            self._refuse(execute, error)
            return
        self._execution = Execution(
            order, self._arm, self._tool, self._end_effector, self._say_account
        )
        self._steps = self._execution.steps()

    def _refuse(self, execute: Execute, error: HardwareError) -> None:
        failure = Failure(error.code, error.detail, timestamp())
        status = CANCELED if isinstance(error, Canceled) else FAILED
        self._link.say(ExecutionAccount(execute.execution_id, status, (), error=failure))

    def _refuse_incoming(self, error: HardwareError) -> None:
        if self._incoming is not None:
            self._refuse(self._incoming[0], error)
            self._incoming = None

    def _acknowledge(self, message: Acknowledge) -> None:
        if self._execution is None:
            self._faults.clear()
            try:
                for execution_id in tuple(self._journal.unfinished):
                    self._journal.end(execution_id, Interrupted.code)
            except JournalFailed as error:
                self._faults.latch(error)
            self._look_around()
        self._say_telemetry(now_due=True)
        self._link.say(AcknowledgeReport(message.request_id, self._faults.failures))

    def _look_around(self) -> None:
        """Check servos and end-effector; what is wrong becomes a fault."""
        if self._journal.unfinished:
            detail = "a worker ended in the middle of an execution; look at the arm"
            self._faults.latch(Interrupted(detail))
        try:
            self._end_effector.switch(on=False)
        except HardwareError:
            self._try(self._end_effector.recover)
        try:
            self._arm.check()
        except BusLost:
            if self._try(self._arm.chain.bus.reopen):
                self._try(self._arm.check)
        except HardwareError as error:
            self._faults.latch(error)

    def _try(self, mend: Callable[[], None]) -> bool:
        """Whether it worked; if not, it is a fault."""
        try:
            mend()
        except HardwareError as error:
            self._faults.latch(error)
            return False
        return True

    # --- Motion -----------------------------------------------------------------------------------
    def _advance(self) -> None:
        try:
            if self._execution is not None:
                if not self._link.is_alive:
                    raise LinkLost("the service was not heard any more")
                if next(self._steps, ALL_DONE) is ALL_DONE:
                    self._finish(self._execution)
            if not self._is_bus_lost:
                self._arm.poll()
            self._end_effector.check()
        except HardwareError as error:
            self._fail(error)
        except Exception as error:
            logger.exception("a defect of the worker")
            self._fail(InternalError(f"{type(error).__name__}; the worker's log has it"))

    @property
    def _is_bus_lost(self) -> bool:
        return not {BusLost.code, PortUnavailable.code}.isdisjoint(self._faults.codes)

    def _fail(self, error: HardwareError) -> None:
        """Make everything safe, end what runs, and latch the fault unless it was asked for."""
        if self._execution is None and self._faults:
            self._faults.latch(error)  # the arm is held already
            return
        safe = make_safe(self._arm, self._end_effector)
        if safe.trouble or not isinstance(error, Canceled):
            self._faults.latch(error, safe.trouble)
        self._end_execution(error)

    def _end_execution(self, error: HardwareError) -> None:
        execution = self._execution
        if execution is not None:
            execution.end(error)
            self._finish(execution)

    def _finish(self, execution: Execution) -> None:
        self._execution = None
        try:
            self._journal.end(execution.account.execution_id, execution.account.status)
        except JournalFailed as error:
            self._faults.latch(error)

    def _stop(self, stop: Stop) -> StopReport:
        safe = make_safe(self._arm, self._end_effector)
        self._refuse_incoming(Stopped("stopped on request"))
        self._faults.latch(Stopped("stopped on request"), safe.trouble)
        self._end_execution(Stopped("stopped on request"))
        return stop_report(stop.request_id, safe, self._arm.torque)

    # --- Telemetry --------------------------------------------------------------------------------
    def _say_account(self, account: ExecutionAccount) -> None:
        if account.status in ENDED:
            # State first: who hears that an execution has ended may look at the arm at once.
            self._say_telemetry(now_due=True)
        self._link.say(account)

    def _say_telemetry(self, *, now_due: bool = False) -> None:
        now = self._clock.now()
        if now < self._telemetry_due and not now_due:
            return
        self._telemetry_due = now + TELEMETRY_S * self._clock.factor
        account = None if self._execution is None else self._execution.account
        if account is not None and account.status in ENDED:
            account = None
        self._link.say(
            telemetry(
                self._arm,
                self._end_effector,
                self._faults.failures,
                account,
                self._overruns,
            )
        )
