"""Executions: taken on, prepared, handed to the worker once, and kept as the worker tells them.

An execution is stored before anything of it is sent, and is sent at most once: neither a lost link
nor a restart sends it again.
"""

import logging
import uuid
from collections.abc import Callable

from sqlalchemy.exc import SQLAlchemyError

from app.services.exceptions import Conflict
from app.services.robots.execution_checks import (
    OrderedPlan,
    check_worker,
    ordered_plan,
    wrong_state,
)
from app.services.robots.execution_record import (
    SOLVER_FAILED,
    STOPPED,
    Execution,
    corrected,
    with_account,
)
from app.services.robots.instances import no_worker
from app.services.robots.leases import LeaseService
from app.services.robots.links import Link, LinkService
from app.services.robots.motions import target_motions
from app.services.robots.orders import Order, OrderBook
from app.services.solving.process import SolverLost
from app.services.solving.service import SolvingService
from app.store import ExecutionStore, NewKey, PlanStore
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
        self._book = OrderBook(store)
        self._plans = plans
        self._solving = solving
        self._links = links
        self._leases = leases

    async def end_interrupted(self) -> None:
        """End what an earlier run of the service left active; nothing of it is sent again."""
        await self._book.end_interrupted()

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
        async with self._book.lock(robot):
            self._leases.check(robot, lease_id)
            link = self._links.get(robot)
            if link is None:
                raise no_worker("Nothing was started.")
            if self._book.get(robot) is not None:
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
            order = await self._book.open(execution, link, key)
            self._book.start(self._prepare(order, plan))
        return execution

    async def _prepare(self, order: Order, plan: OrderedPlan) -> None:
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
        async with self._book.lock(robot):
            if order.withdrawn or self._book.get(robot) is not order:
                return
            if isinstance(motions, Failure):
                await self._book.end(order, FAILED, motions)
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
        return await self._book.document(execution_id)

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
        robot = (await self._book.execution(execution_id)).robot
        async with self._book.lock(robot):
            self._leases.check(robot, lease_id)
            execution = await self._book.execution(execution_id)
            order = self._book.get(robot)
            if execution.status not in allowed or order is None:
                raise wrong_state(execution, allowed)
            if order.canceling and command is not Cancel:
                raise Conflict("wrong_state", "The execution is being canceled.")
            order.canceling |= command is Cancel
            withdrawn = command is Cancel and order.withdraw()
            if order.handed_over:
                order.link.outbox.send(command(execution_id))
            return await self._book.end(order, CANCELED, None) if withdrawn else execution

    def withdraw(self, robot: str) -> None:
        """Keep an execution that has not begun from beginning: somebody asked for a stop."""
        order = self._book.get(robot)
        if order is not None:
            order.withdraw()
        # One that is just being taken on is behind the lock.
        self._book.start(self._end_stopped(robot))

    async def _end_stopped(self, robot: str) -> None:
        async with self._book.lock(robot):
            order = self._book.get(robot)
            if order is not None and order.withdraw():
                detail = "somebody asked for a stop before the arm had begun"
                await self._book.end(order, FAILED, Failure(STOPPED, detail, timestamp()))

    async def take_account(self, link: Link, account: ExecutionAccount) -> None:
        """Keep what a worker tells of an execution; accounts of others' are ignored."""
        async with self._book.lock(link.robot):
            execution = await self._book.find(account.execution_id)
            if execution is not None and execution.robot != link.robot:
                execution = None
            if execution is not None and not execution.ended:
                told = with_account(execution, account, timestamp())
                if told != execution:
                    await self._book.save(told)
                return
            if execution is not None and execution.may_be_corrected:
                await self._book.save(corrected(execution, account))
            if account.status not in ENDED:
                # It was given up here while the worker was out of sight.
                link.outbox.send(Cancel(account.execution_id))

    async def link_ended(self, link: Link, code: str, detail: str) -> None:
        """End what the link's worker was executing; nobody sees the arm any more."""
        async with self._book.lock(link.robot):
            order = self._book.get(link.robot)
            if order is None or order.link is not link:
                return
            order.withdraw()
            try:
                await self._book.end(order, FAILED, Failure(code, detail, timestamp()))
            except SQLAlchemyError:
                logger.exception("execution %s could not be ended", order.execution_id)

    async def close(self) -> None:
        """Drop what is being prepared; the next start ends it."""
        await self._book.close()
