"""Connections that end when their client does not go on, in either direction.

Uvicorn waits for ever for a request's head, and for an answer to be read.
"""

import asyncio
from dataclasses import dataclass
from typing import Any, Final

from uvicorn.protocols.http.h11_impl import H11Protocol

LEAST_READ_BYTES: Final = 16 * 1024
"""Less than this within the write time-out is no reading, but holding on."""


@dataclass(frozen=True)
class Patience:
    """How long a connection waits.

    Attributes:
        head_s: for a whole request head, from its first byte or from the connection's start.
        write_s: for LEAST_READ_BYTES of an answer to be read.
    """

    head_s: float
    write_s: float


def impatient_protocol(patience: Patience) -> type[asyncio.Protocol]:
    """Uvicorn's HTTP protocol with these limits; a class, as uvicorn makes the connections."""

    class ImpatientProtocol(H11Protocol):
        def __init__(self, *arguments: Any, **keywords: Any) -> None:
            super().__init__(*arguments, **keywords)
            self._head_timer: asyncio.TimerHandle | None = None
            self._write_timer: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            super().connection_made(transport)  # type: ignore[arg-type]
            self._await_head()

        def data_received(self, data: bytes) -> None:
            cycle = self.cycle
            super().data_received(data)
            if self.cycle is not cycle or self.transport.get_protocol() is not self:
                self._stop_head_timer()
            elif self.cycle is None or self.cycle.response_complete:
                self._await_head()

        def on_response_complete(self) -> None:
            super().on_response_complete()
            self._await_reader()

        def send_400_response(self, msg: str) -> None:
            super().send_400_response(msg)
            self._await_reader()

        def pause_writing(self) -> None:
            super().pause_writing()
            self._await_reader()

        def resume_writing(self) -> None:
            # The client has read most of it; what a stream writes next counts anew.
            self._stop_write_timer()
            super().resume_writing()

        def connection_lost(self, exc: Exception | None) -> None:
            self._stop_head_timer()
            self._stop_write_timer()
            super().connection_lost(exc)

        def _stop_head_timer(self) -> None:
            if self._head_timer is not None:
                self._head_timer.cancel()
                self._head_timer = None

        def _stop_write_timer(self) -> None:
            if self._write_timer is not None:
                self._write_timer.cancel()
                self._write_timer = None

        def _await_head(self) -> None:
            if self._head_timer is None:
                self._head_timer = self.loop.call_later(patience.head_s, self._give_up)

        def _give_up(self) -> None:
            self._head_timer = None
            if self.cycle is None or self.cycle.response_complete:
                self.transport.abort()

        def _await_reader(self) -> None:
            left_bytes = self.transport.get_write_buffer_size()
            if self._write_timer is None and left_bytes:
                self._write_timer = self.loop.call_later(
                    patience.write_s, self._check_reader, left_bytes
                )

        def _check_reader(self, left_bytes: int) -> None:
            self._write_timer = None
            now_bytes = self.transport.get_write_buffer_size()
            if now_bytes and left_bytes - now_bytes < LEAST_READ_BYTES:
                self.transport.abort()
            else:
                self._await_reader()

    return ImpatientProtocol
