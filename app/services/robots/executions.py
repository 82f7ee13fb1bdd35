"""Executions: taken on, prepared, handed to the worker once, and kept as the worker tells them.

An execution is stored before anything of it is sent, and is sent at most once: neither a lost link
nor a restart sends it again. A robot's executions change one after the other, under its lock.
"""

import asyncio
import contextlib
import logging
import uuid
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from app.services.exceptions import Conflict
from app.services.robots.execution_checks import (
    OrderedPlan,
    check_worker,
    execution_not_found,
    no_worker,
    ordered_plan,
    wrong_state,
)
from app.services.robots.execution_record import (
    SERVICE_RESTARTED,
    SOLVER_FAILED,
    STOPPED,
    STORE_LOST,
    Execution,
    corrected,
    ended,
    execution_from_json,
    execution_to_json,
    with_account,
)
from app.services.robots.leases import LeaseService
from app.services.robots.links import Link, LinkService
from app.services.robots.motions import target_motions
from app.services.solving.process import SolverLost
from app.services.solving.service import SolvingService
from app.services.store_calls import store_call
from app.store import ACCEPTED, ExecutionStore, NewKey, PlanStore, RobotBusy, new_entry
from hardware.clock import timestamp
from hardware.link.messages import (
    CANCELED,
    ENDED,
    EXECUTING,
    FAILED,
    PAUSED,
    QUEUED,
    Cancel,
    Execute,
    ExecutionAccount,
    Failure,
    Pause,
    Resume,
    encode,
)

logger = logging.getLogger(__name__)

# What must be stored is tried again this often until the database is back.
STORE_RETRY_S = 1.0


@dataclass
class _Order:
    """An active execution's way to its worker.

    Attributes:
        handed_over: its messages are with the link.
        withdrawn: the worker will never have all of them, so it cannot begin.
        canceling: a cancel was accepted; nothing takes it back.
        ending: its end could not be stored yet, and is being tried again.
    """

    execution_id: str
    link: Link
    handed_over: bool = False
    withdrawn: bool = False
    canceling: bool = False
    ending: bool = False

    def withdraw(self) -> bool:
        """Keep the worker from beginning; False if it may have begun."""
        if not self.withdrawn:
            self.withdrawn = self.link.outbox.withdraw() if self.handed_over else True
        return self.withdrawn


class ExecutionService:
    """The executions of every robot. It lives on the event loop and is used there only."""

    def __init__(
        self,
        store: ExecutionStore,
        plans: PlanStore,
        solving: SolvingService,
        links: LinkService,
        leases: LeaseService,
    ) -> None:
        self._store = store
        self._plans = plans
        self._solving = solving
        self._links = links
        self._leases = leases
        self._orders: dict[str, _Order] = {}
        self._locks: dict[str, asyncio.Lock] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def end_interrupted(self) -> None:
        """End what an earlier run of the service left active; nothing of it is sent again."""
        for document in await store_call(self._store.active):
            execution = execution_from_json(document)
            await self._fail(execution, SERVICE_RESTARTED, "the service was started again")

    async def create(
        self, plan_id: str, robot: str, key: NewKey | None = None, *, lease_id: str = ""
    ) -> Execution:
        """Take on an execution of a plan; it is stored as queued when this returns.

        While somebody has a lease of the robot, `lease_id` must be its id, here and below.

        Raises:
            NotFound: no such plan or robot.
            InvalidRequest: no target of the plan can be approached.
            Conflict: the robot is busy, leased to another, has a fault, or does not fit the plan.
            Unavailable: no worker is connected.
            KeyTaken: something was created under the key before.
        """
        plan = await ordered_plan(self._plans, plan_id, robot)
        async with self._lock(robot):
            self._leases.check(robot, lease_id)
            link = self._links.get(robot)
            if link is None:
                raise no_worker("Nothing was started.")
            if robot in self._orders:
                raise Conflict("busy", "The robot has an active execution.")
            check_worker(plan, link)
            now = timestamp()
            execution = Execution(
                id=uuid.uuid4().hex,
                plan_id=plan_id,
                robot=robot,
                simulated=link.hello.simulated,
                status=QUEUED,
                created_at=now,
                targets=plan.targets(now),
            )
            await self._add(execution, key)
            order = self._orders[robot] = _Order(execution.id, link)
            self._start(self._prepare(order, plan))
        return execution

    async def _add(self, execution: Execution, key: NewKey | None) -> None:
        document = execution_to_json(execution)
        try:
            await store_call(
                self._store.add,
                execution.id,
                plan_id=execution.plan_id,
                robot=execution.robot,
                status=execution.status,
                created_at=datetime.fromisoformat(execution.created_at),
                document=document,
                key=new_entry(key, ACCEPTED, execution.location, document),
            )
        except RobotBusy:
            raise Conflict("busy", "The robot has an active execution.") from None
        except SQLAlchemyError:
            # It may be stored all the same, and nobody would ever end it.
            self._start(self._end_unaccounted(execution))
            raise

    async def _end_unaccounted(self, execution: Execution) -> None:
        detail = "the database was lost while it was taken on; nothing was sent"
        while True:
            try:
                await self._fail(execution, STORE_LOST, detail)
            except SQLAlchemyError:
                await asyncio.sleep(STORE_RETRY_S)
            else:
                return

    async def _prepare(self, order: _Order, plan: OrderedPlan) -> None:
        try:
            motions = await self._solving.run(
                target_motions, plan.request, plan.answer, order.execution_id
            )
        except SolverLost:
            motions = Failure(SOLVER_FAILED, "the solver was lost over the plan", timestamp())
        except Exception:
            logger.exception("the motions of execution %s could not be built", order.execution_id)
            detail = "the plan's motions could not be built; the service's log says more"
            motions = Failure(SOLVER_FAILED, detail, timestamp())
        robot = order.link.robot
        async with self._lock(robot):
            if order.withdrawn or self._orders.get(robot) is not order:
                return
            if isinstance(motions, Failure):
                await self._end(order, FAILED, motions)
                return
            execute = Execute(
                execution_id=order.execution_id,
                plan_id=plan.id,
                tool=plan.tool,
                model_version=plan.model_version,
                start_joints=plan.start_joints,
                target_count=len(motions),
            )
            order.handed_over = True
            order.link.outbox.hand_over((encode(execute), *motions))

    async def document(self, execution_id: str) -> str:
        """The body of the answer for an execution.

        Raises:
            NotFound: there is none of this id.
        """
        document = await store_call(self._store.document, execution_id)
        if document is None:
            raise execution_not_found()
        return document

    async def pause(self, execution_id: str, *, lease_id: str = "") -> Execution:
        """Ask the worker to pause; its account says when it has.

        Raises:
            NotFound: there is none of this id.
            Conflict: it is not executing, or the robot is leased to another.
        """
        return await self._command(execution_id, lease_id, Pause, (EXECUTING,))

    async def resume(self, execution_id: str, *, lease_id: str = "") -> Execution:
        """Ask the worker to go on; its account says when it does.

        Raises:
            NotFound: there is none of this id.
            Conflict: it is not paused, or the robot is leased to another.
        """
        return await self._command(execution_id, lease_id, Resume, (PAUSED,))

    async def cancel(self, execution_id: str, *, lease_id: str = "") -> Execution:
        """Cancel: at once while the worker cannot have begun, else as soon as it stands.

        Raises:
            NotFound: there is none of this id.
            Conflict: it has ended, or the robot is leased to another.
        """
        return await self._command(execution_id, lease_id, Cancel, (QUEUED, EXECUTING, PAUSED))

    async def _command(
        self,
        execution_id: str,
        lease_id: str,
        command: Callable[[str], Pause | Resume | Cancel],
        allowed: tuple[str, ...],
    ) -> Execution:
        robot = execution_from_json(await self.document(execution_id)).robot
        async with self._lock(robot):
            self._leases.check(robot, lease_id)
            execution = execution_from_json(await self.document(execution_id))
            order = self._orders.get(robot)
            if execution.status not in allowed or order is None:
                raise wrong_state(execution, allowed)
            if order.canceling and command is not Cancel:
                raise Conflict("wrong_state", "The execution is being canceled.")
            order.canceling |= command is Cancel
            withdrawn = command is Cancel and order.withdraw()
            if order.handed_over:
                order.link.outbox.send(command(execution_id))
            return await self._end(order, CANCELED, None) if withdrawn else execution

    def withdraw(self, robot: str) -> None:
        """Keep an execution that has not begun from beginning: somebody asked for a stop."""
        order = self._orders.get(robot)
        if order is not None:
            order.withdraw()
        # One that is just being taken on is behind the lock.
        self._start(self._end_stopped(robot))

    async def _end_stopped(self, robot: str) -> None:
        async with self._lock(robot):
            order = self._orders.get(robot)
            if order is not None and order.withdraw():
                detail = "somebody asked for a stop before the arm had begun"
                await self._end(order, FAILED, Failure(STOPPED, detail, timestamp()))

    async def take_account(self, link: Link, account: ExecutionAccount) -> None:
        """Keep what a worker tells of an execution; accounts of others' are ignored."""
        async with self._lock(link.robot):
            document = await store_call(self._store.document, account.execution_id)
            execution = None if document is None else execution_from_json(document)
            if execution is not None and execution.robot != link.robot:
                execution = None
            if execution is not None and not execution.ended:
                told = with_account(execution, account, timestamp())
                if told != execution:
                    await self._save(told)
                return
            if execution is not None and execution.may_be_corrected:
                await self._save(corrected(execution, account))
            if account.status not in ENDED:
                # It was given up here while the worker was out of sight.
                link.outbox.send(Cancel(account.execution_id))

    async def link_ended(self, link: Link, code: str, detail: str) -> None:
        """End what the link's worker was executing; nobody sees the arm any more."""
        async with self._lock(link.robot):
            order = self._orders.get(link.robot)
            if order is None or order.link is not link:
                return
            order.withdraw()
            try:
                await self._end(order, FAILED, Failure(code, detail, timestamp()))
            except SQLAlchemyError:
                logger.exception("execution %s could not be ended", order.execution_id)

    async def _end(self, order: _Order, status: str, error: Failure | None) -> Execution:
        try:
            return await self._end_now(order, status, error)
        except SQLAlchemyError:
            # The robot is free again only when this is stored; the caller need not come back.
            if not order.ending:
                order.ending = True
                self._start(self._end_later(order, status, error))
            raise

    async def _end_later(self, order: _Order, status: str, error: Failure | None) -> None:
        robot = order.link.robot
        while self._orders.get(robot) is order:
            await asyncio.sleep(STORE_RETRY_S)
            async with self._lock(robot):
                if self._orders.get(robot) is order:
                    with contextlib.suppress(SQLAlchemyError):
                        await self._end_now(order, status, error)

    async def _end_now(self, order: _Order, status: str, error: Failure | None) -> Execution:
        execution = execution_from_json(await self.document(order.execution_id))
        execution = ended(execution, status, error, timestamp())
        await self._save(execution)
        return execution

    async def _fail(self, execution: Execution, code: str, detail: str) -> None:
        failure = Failure(code, detail, timestamp())
        await self._save(ended(execution, FAILED, failure, timestamp()))

    async def _save(self, execution: Execution) -> None:
        await store_call(
            self._store.save,
            execution.id,
            status=execution.status,
            document=execution_to_json(execution),
            ended=execution.ended,
        )
        order = self._orders.get(execution.robot)
        if execution.ended and order is not None and order.execution_id == execution.id:
            order.withdraw()
            del self._orders[execution.robot]

    def _lock(self, robot: str) -> asyncio.Lock:
        return self._locks.setdefault(robot, asyncio.Lock())

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._done)

    def _done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            logger.error("work on an execution failed", exc_info=error)

    async def close(self) -> None:
        """Drop what is being prepared; the next start ends it."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
