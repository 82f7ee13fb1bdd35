"""The orders under way, and their executions in the store, whatever becomes of the database."""

import asyncio
import contextlib
import logging
from collections.abc import Coroutine
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from app.services.exceptions import Conflict
from app.services.robots.execution_checks import execution_not_found
from app.services.robots.execution_record import (
    SERVICE_RESTARTED,
    STORE_LOST,
    Execution,
    ended,
    execution_from_json,
    execution_to_json,
)
from app.services.robots.links import Link
from app.services.store_calls import store_call
from app.store import ACCEPTED, ExecutionStore, NewKey, RobotBusy, new_entry
from hardware.clock import timestamp
from hardware.link.messages import FAILED, Failure

logger = logging.getLogger(__name__)

# What must be stored is tried again this often until the database is back.
STORE_RETRY_S = 1.0


@dataclass
class Order:
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


class OrderBook:
    """The active orders by robot. It lives on the event loop and is used there only.

    A robot's orders and executions change one after the other: whoever changes them holds its
    lock.
    """

    def __init__(self, store: ExecutionStore) -> None:
        self._store = store
        self._orders: dict[str, Order] = {}
        self._locks: dict[str, asyncio.Lock] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    def lock(self, robot: str) -> asyncio.Lock:
        """The robot's lock."""
        return self._locks.setdefault(robot, asyncio.Lock())

    def get(self, robot: str) -> Order | None:
        """The robot's active order."""
        return self._orders.get(robot)

    async def end_interrupted(self) -> None:
        """End what an earlier run of the service left active; nothing of it is sent again."""
        for document in await store_call(self._store.active):
            execution = execution_from_json(document)
            await self._fail(execution, SERVICE_RESTARTED, "the service was started again")

    async def find(self, execution_id: str) -> Execution | None:
        """The execution of that id, if there is one."""
        document = await store_call(self._store.document, execution_id)
        return None if document is None else execution_from_json(document)

    async def document(self, execution_id: str) -> str:
        """The body of the answer for an execution.

        Raises:
            NotFound: there is none of this id.
        """
        document = await store_call(self._store.document, execution_id)
        if document is None:
            raise execution_not_found()
        return document

    async def execution(self, execution_id: str) -> Execution:
        """The execution of that id.

        Raises:
            NotFound: there is none of this id.
        """
        return execution_from_json(await self.document(execution_id))

    async def open(self, execution: Execution, link: Link, key: NewKey | None) -> Order:
        """The order for a new execution, which is stored when this returns.

        Raises:
            Conflict: the robot has an active execution in the store.
            KeyTaken: something was created under the key before.
        """
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
            self.start(self._end_unaccounted(execution))
            raise
        order = self._orders[execution.robot] = Order(execution.id, link)
        return order

    async def _end_unaccounted(self, execution: Execution) -> None:
        detail = "the database was lost while it was taken on; nothing was sent"
        while True:
            try:
                await self._fail(execution, STORE_LOST, detail)
            except SQLAlchemyError:
                await asyncio.sleep(STORE_RETRY_S)
            else:
                return

    async def end(self, order: Order, status: str, error: Failure | None) -> Execution:
        """End an order and its execution; it is tried again if the store fails now.

        Raises:
            SQLAlchemyError: the store failed.
        """
        try:
            return await self._end_now(order, status, error)
        except SQLAlchemyError:
            # The robot is free again only when this is stored; the caller need not come back.
            if not order.ending:
                order.ending = True
                self.start(self._end_later(order, status, error))
            raise

    async def _end_later(self, order: Order, status: str, error: Failure | None) -> None:
        robot = order.link.robot
        while self._orders.get(robot) is order:
            await asyncio.sleep(STORE_RETRY_S)
            async with self.lock(robot):
                if self._orders.get(robot) is order:
                    with contextlib.suppress(SQLAlchemyError):
                        await self._end_now(order, status, error)

    async def _end_now(self, order: Order, status: str, error: Failure | None) -> Execution:
        execution = await self.execution(order.execution_id)
        execution = ended(execution, status, error, timestamp())
        await self.save(execution)
        return execution

    async def _fail(self, execution: Execution, code: str, detail: str) -> None:
        failure = Failure(code, detail, timestamp())
        await self.save(ended(execution, FAILED, failure, timestamp()))

    async def save(self, execution: Execution) -> None:
        """Store an execution as it stands; one that has ended frees its robot."""
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

    def start(self, work: Coroutine[Any, Any, None]) -> None:
        """Begin what nobody waits for; it is dropped with the service."""
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._done)

    def _done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            logger.error("work on an execution failed", exc_info=error)

    async def close(self) -> None:
        """Drop what was begun; the next start of the service ends the executions."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
