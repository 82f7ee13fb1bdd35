"""Running the service on a socket of its own."""

import asyncio
import logging
import socket

import typer
import uvicorn
from alembic.util import CommandError
from sqlalchemy.exc import SQLAlchemyError

from app.main import create_app
from app.processes import READY_LINE
from app.settings import Settings
from app.store import open_engine
from app.store.failures import cause_of
from app.store.single_service import DatabaseInUse, Hold, hold_database
from hardware.instances import instance_names, load_instance
from solver import InvalidRobot

logger = logging.getLogger(__name__)

# Requests still being answered at the end get this long.
GRACE_S = 5
# An account of several thousand targets, measured postures and all, has 2 MiB.
LONGEST_MESSAGE_BYTES = 8 * 1024 * 1024


class CannotServe(Exception):
    """The service cannot start, and why in one line."""


class _Server(uvicorn.Server):
    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started and sockets:
            host, port = sockets[0].getsockname()[:2]
            shown = f"[{host}]" if ":" in host else host
            typer.echo(f"{READY_LINE}http://{shown}:{port}")


def run_service(settings: Settings) -> None:
    """Serve until a signal ends it.

    Raises:
        CannotServe: the address is taken or not this machine's, a model file is broken, or the
            start-up failed.
    """
    try:
        for name in instance_names():
            load_instance(name)
    except (InvalidRobot, OSError) as error:
        raise CannotServe(f"a robot's model file cannot be used: {error}") from None
    try:
        if not settings.database_url:
            settings.data_dir.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CannotServe(f"cannot use {settings.data_dir}: {error.strerror}") from None
    listener = _bind(settings.host, settings.port)
    config = uvicorn.Config(
        create_app(settings),
        log_level="warning",
        access_log=False,
        timeout_graceful_shutdown=GRACE_S,
        server_header=False,
        ws_max_size=LONGEST_MESSAGE_BYTES,
        ws_ping_interval=None,  # the link has heartbeats of its own, more of them
        ws_per_message_deflate=False,  # numbers hardly shrink, and compressing holds up the loop
    )
    server = _Server(config)
    try:
        hold = _hold(settings, server)
    except CannotServe:
        listener.close()
        raise
    try:
        server.run(sockets=[listener])
    except (KeyboardInterrupt, asyncio.CancelledError):
        return
    finally:
        hold.release()
        listener.close()
    if not server.started:
        raise CannotServe("the service could not start; the log above says why")


def _hold(settings: Settings, server: uvicorn.Server) -> Hold:
    """The database, held for this service alone and brought to the newest schema."""

    def end() -> None:
        logger.critical("another service took the database while it was lost; this one ends")
        server.should_exit = True

    try:
        url = settings.resolved_database_url
        hold = hold_database(url, end)
        try:
            open_engine(url).dispose()
        except BaseException:
            hold.release()
            raise
    except DatabaseInUse as error:
        raise CannotServe(str(error)) from None
    except SQLAlchemyError as error:
        raise CannotServe(f"the database cannot be used: {cause_of(error)}") from None
    except CommandError as error:
        raise CannotServe(f"the database is not this version's: {error}") from None
    except OSError as error:
        raise CannotServe(f"cannot use {error.filename}: {error.strerror}") from None
    return hold


def _bind(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listener = socket.socket(family, kind, protocol)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(address)
        except OSError:
            listener.close()
            raise
    except OSError as error:
        raise CannotServe(f"cannot listen on {host}:{port}: {error.strerror}") from None
    return listener
