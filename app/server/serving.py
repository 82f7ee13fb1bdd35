"""Running the service on a socket of its own."""

import asyncio
import contextlib
import logging
import socket
from types import FrameType

import typer
import uvicorn
from alembic.util import CommandError
from sqlalchemy.exc import SQLAlchemyError

from app.guards.traffic import DRAIN_POLL_S, Traffic
from app.observation.logs import configure_logs
from app.server.application import create_app
from app.server.connection import Patience, impatient_protocol
from app.server.processes import READY_LINE
from app.services.solving.long_lived import keep_for_good
from app.settings import Settings, is_loopback
from app.store import TokenStore, open_engine
from app.store.failures import cause_of
from app.store.single_service import DatabaseInUse, Hold, hold_database
from hardware.servos.instances import instance_names, load_instance
from solver import InvalidRobot

logger = logging.getLogger(__name__)

# Streams and robot links are told to end once the requests are answered, and get this long.
LAST_S = 5
# Connections may be open between requests, and there is room left for a stop when the service is
# busy: what is over this gets uvicorn's own plain 503.
CONNECTIONS_PER_REQUEST = 2
# An account of several thousand targets, measured postures and all, has 2 MiB.
LONGEST_MESSAGE_BYTES = 8 * 1024 * 1024


class CannotServe(Exception):
    """The service cannot start, and why in one line."""


class _Server(uvicorn.Server):
    """Ends in two steps: what is being answered first, while it still listens; then the rest."""

    def __init__(self, config: uvicorn.Config, traffic: Traffic, grace_s: float) -> None:
        super().__init__(config)
        self._traffic = traffic
        self._grace_s = grace_s
        self._loop: asyncio.AbstractEventLoop | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        self._loop = asyncio.get_running_loop()
        await super().startup(sockets)
        keep_for_good()
        if self.started and sockets:
            host, port = sockets[0].getsockname()[:2]
            shown = f"[{host}]" if ":" in host else host
            typer.echo(f"{READY_LINE}http://{shown}:{port}")

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """The first signal begins the end; a second one is it.

        Uvicorn would raise the signal again at the end, so that the process did not end with 0.
        """
        self.force_exit = self.should_exit
        self.should_exit = True
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._traffic.stopping.set)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._traffic.stopping.set()
        # A listener closed at once would reset connections that nobody has accepted yet.
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(self._grace_s):
                while self._traffic.in_flight and not self.force_exit:
                    await asyncio.sleep(DRAIN_POLL_S)
        await super().shutdown(sockets)


def run_service(settings: Settings) -> None:
    """Serve until a signal ends it.

    Raises:
        CannotServe: the address is taken or not this machine's, a model file is broken, tokens
            are required and there is none, or the start-up failed.
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
    if settings.token_required:
        _check_tokens(settings)
    listener = _bind(settings.host, settings.port)
    configure_logs(settings.log_options)
    traffic = Traffic()
    app = create_app(settings, traffic)
    patience = Patience(settings.head_timeout_s, settings.write_timeout_s)
    config = uvicorn.Config(
        app,
        http=impatient_protocol(patience),
        log_config=None,
        access_log=False,
        timeout_keep_alive=settings.keep_alive_s,
        timeout_graceful_shutdown=LAST_S,
        limit_concurrency=CONNECTIONS_PER_REQUEST * settings.most_requests,
        server_header=False,
        ws_max_size=LONGEST_MESSAGE_BYTES,
        ws_ping_interval=None,  # the link has heartbeats of its own, more of them
        ws_per_message_deflate=False,  # numbers hardly shrink, and compressing holds up the loop
    )
    server = _Server(config, traffic, settings.grace_s)
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


def _check_tokens(settings: Settings) -> None:
    try:
        engine = open_engine(settings.resolved_database_url)
        try:
            found = TokenStore(engine).has_valid()
        finally:
            engine.dispose()
    except SQLAlchemyError:
        # A driver's message may have the URL in it, and that the password.
        raise CannotServe("the store does not answer, so there is no looking for tokens") from None
    if not found:
        where = (
            "where PRUNUS_REQUIRE_TOKEN says so" if is_loopback(settings.host) else "off loopback"
        )
        raise CannotServe(
            f"a token is required {where}, and there is none that is valid; "
            "make one: prunus token create --name NAME --scope SCOPE"
        )


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
