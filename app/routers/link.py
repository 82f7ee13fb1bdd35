"""The robot link: the WebSocket over which an arm's worker joins."""

import asyncio
import contextlib
import logging
from dataclasses import dataclass

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from sqlalchemy.exc import SQLAlchemyError

from app.routers.dependencies import TheExecutions, TheLinks
from app.services.robots.execution_record import LINK_LOST, SERVICE_RESTARTED, STATUSES, WORKER_LOST
from app.services.robots.executions import ExecutionService
from app.services.robots.links import NOT_A_MESSAGE, SILENT, Link, LinkRefused, LinkService
from hardware.link.messages import (
    SILENCE_S,
    ExecutionAccount,
    FromWorker,
    Hello,
    InvalidMessage,
    Telemetry,
    Welcome,
    decode_from_worker,
)

logger = logging.getLogger(__name__)
router = APIRouter()

# What has arrived while the service itself was held up is read before the worker counts as silent.
ALREADY_THERE_S = 0.1
ACCOUNTS_WAITING = 64
CLOSING_S = 1.0
SERVICE_FAULT = 1011
SERVICE_ENDS = 1012


@dataclass(frozen=True)
class _End:
    """How a link ended: an execution's error, and what the worker is told, if it is there."""

    code: str
    detail: str
    close_code: int = 0
    close_reason: str = ""


@router.websocket("/v1/robots/{name}/link")
async def robot_link(
    websocket: WebSocket, name: str, links: TheLinks, executions: TheExecutions
) -> None:
    """One worker a robot. The first message is its hello; see `hardware.link.messages`."""
    await websocket.accept()
    try:
        hello = await _hello(websocket)
        link = links.join(await links.instance(name), hello)
    except WebSocketDisconnect:
        return
    except LinkRefused as refusal:
        await _close(websocket, refusal.code, refusal.reason)
        return
    link.outbox.send(Welcome(name))
    try:
        end = await _converse(websocket, links, link, executions)
    except Exception:
        await executions.link_ended(link, LINK_LOST, "the service lost the link by its own fault")
        raise
    await executions.link_ended(link, end.code, end.detail)
    if end.close_code:
        logger.warning("link of %s closed: %s", name, end.close_reason)
        await _close(websocket, end.close_code, end.close_reason)


async def _hello(websocket: WebSocket) -> Hello:
    try:
        message = await _receive(websocket)
    except InvalidMessage:
        message = None
    except TimeoutError:
        raise LinkRefused(SILENT, f"No hello came within {SILENCE_S:g} s.") from None
    if not isinstance(message, Hello):
        raise LinkRefused(NOT_A_MESSAGE, "The first message must be a hello.")
    return message


async def _converse(
    websocket: WebSocket, links: LinkService, link: Link, executions: ExecutionService
) -> _End:
    """Read, write and keep accounts until one of the three ends."""
    accounts: asyncio.Queue[ExecutionAccount] = asyncio.Queue(ACCOUNTS_WAITING)
    reader = asyncio.create_task(_read(websocket, link, accounts))
    writer = asyncio.create_task(_write(websocket, link))
    keeper = asyncio.create_task(_keep(link, accounts, executions))
    kept: asyncio.Task[None] | None = None
    try:
        await asyncio.wait((reader, writer, keeper), return_when=asyncio.FIRST_COMPLETED)
        links.leave(link)
        for task in (reader, writer):
            task.cancel()
        # What the worker said last counts: it may have ended its execution before it left.
        kept = asyncio.create_task(accounts.join())
        await asyncio.wait((kept, keeper), return_when=asyncio.FIRST_COMPLETED)
    finally:
        links.leave(link)
        for started in (reader, writer, keeper, kept):
            if started is not None:
                started.cancel()
    await asyncio.wait((reader, writer, keeper))
    return next(task.result() for task in (reader, writer, keeper) if not task.cancelled())


async def _read(
    websocket: WebSocket, link: Link, accounts: asyncio.Queue[ExecutionAccount]
) -> _End:
    while True:
        try:
            message = await _receive(websocket)
        except WebSocketDisconnect as error:
            if error.code == SERVICE_ENDS:
                return _End(SERVICE_RESTARTED, "the service was stopped")
            return _closed(error)
        except TimeoutError:
            return _silent(f"nothing was heard from the worker for {SILENCE_S:g} s")
        except InvalidMessage:
            return _not_a_message("This is no message of the link.")
        if isinstance(message, Telemetry):
            link.take_telemetry(message)
        elif isinstance(message, ExecutionAccount):
            if message.status not in STATUSES:
                return _not_a_message("An execution's status is none that the link knows.")
            await accounts.put(message)
        elif isinstance(message, Hello):
            return _not_a_message("A hello comes once.")
        else:
            link.take_answer(message)


async def _write(websocket: WebSocket, link: Link) -> _End:
    while True:
        text = await link.outbox.take()
        try:
            async with asyncio.timeout(SILENCE_S):
                await websocket.send_text(text)
        except TimeoutError:
            return _silent(f"the worker did not read for {SILENCE_S:g} s")
        except WebSocketDisconnect as error:
            return _closed(error)


async def _keep(
    link: Link, accounts: asyncio.Queue[ExecutionAccount], executions: ExecutionService
) -> _End:
    while True:
        account = await accounts.get()
        try:
            await executions.take_account(link, account)
        except SQLAlchemyError:
            logger.exception("an account of %s could not be stored", link.robot)
            detail = "what the worker told could not be stored"
            return _End(LINK_LOST, detail, SERVICE_FAULT, "The service cannot store accounts.")
        accounts.task_done()


async def _receive(websocket: WebSocket) -> FromWorker:
    try:
        async with asyncio.timeout(SILENCE_S):
            message = await websocket.receive()
    except TimeoutError:
        async with asyncio.timeout(ALREADY_THERE_S):
            message = await websocket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"])
    return decode_from_worker(message.get("text") or message.get("bytes") or b"")


def _closed(error: WebSocketDisconnect) -> _End:
    return _End(WORKER_LOST, f"the link to the worker was closed (code {error.code})")


def _silent(detail: str) -> _End:
    return _End(LINK_LOST, detail, SILENT, f"{detail[0].upper()}{detail[1:]}.")


def _not_a_message(reason: str) -> _End:
    return _End(WORKER_LOST, "the worker sent something else than messages", NOT_A_MESSAGE, reason)


async def _close(websocket: WebSocket, code: int, reason: str) -> None:
    with contextlib.suppress(TimeoutError, WebSocketDisconnect, RuntimeError):
        async with asyncio.timeout(CLOSING_S):
            await websocket.close(code, reason)
