"""Runs a simulated bus on a pseudo-terminal, with fault commands from a file or terminal."""

import contextlib
import os
import select
import signal
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

from hardware.exceptions import PortUnavailable
from hardware.simulator.bus import SimulatedBus
from hardware.simulator.faults import FaultRefused, apply_fault

CHUNK = 4096


def serve_bus(
    bus: SimulatedBus,
    *,
    announce: Callable[[str], None],
    complain: Callable[[str], None],
    commands: int | None = None,
    link: Path | None = None,
) -> None:
    """Answer on a new pseudo-terminal until it is unplugged or the program is told to end.

    Args:
        bus: who answers.
        announce: gets the device's path once it is there.
        complain: gets one line for each command that is refused.
        commands: a file descriptor to read fault commands from, one a line; its end changes
            nothing else.
        link: a symbolic link to the device, there as long as the device is.

    Raises:
        PortUnavailable: the link cannot be made.
    """
    with _ending_signals() as ended, _terminal() as (port, device), _linked(link, device):
        announce(device)
        sources = [port, ended] if commands is None else [port, ended, commands]
        lines = _Lines()
        while not bus.unplugged:
            ready, _, _ = select.select(sources, [], [])
            if ended in ready:
                return
            if commands in ready:
                data = _read(commands)
                if not data:
                    sources.remove(commands)
                for line in lines.feed(data):
                    _obey(bus, line, complain)
            if port in ready and not bus.unplugged:
                _send(port, bus.respond(os.read(port, CHUNK)))


class _Lines:
    """Cuts what is read into lines; the end of the file ends the last one."""

    def __init__(self) -> None:
        self._waiting = b""

    def feed(self, data: bytes) -> Iterator[str]:
        *lines, self._waiting = (self._waiting + (data or b"\n")).split(b"\n")
        yield from (line.decode(errors="replace") for line in lines)


def _obey(bus: SimulatedBus, line: str, complain: Callable[[str], None]) -> None:
    try:
        apply_fault(bus, line)
    except FaultRefused as error:
        complain(str(error))


def _read(descriptor: int) -> bytes:
    # A terminal that this program does not have, because it runs in the background, is as good as
    # a closed one.
    try:
        return os.read(descriptor, CHUNK)
    except OSError:
        return b""


def _send(port: int, answer: bytes) -> None:
    # What nobody reads is lost, as on a real line; waiting would keep the program from ending.
    with contextlib.suppress(BlockingIOError):
        os.write(port, answer)


@contextlib.contextmanager
def _terminal() -> Iterator[tuple[int, str]]:
    port, client = os.openpty()
    try:
        # Raw, or the line discipline would echo and change bytes. The client's side stays open
        # here, or reading would fail whenever no client has it open.
        tty.setraw(client)
        os.set_blocking(port, False)
        yield port, os.ttyname(client)
    finally:
        os.close(port)
        os.close(client)


@contextlib.contextmanager
def _linked(link: Path | None, device: str) -> Iterator[None]:
    if link is None:
        yield
        return
    if link.is_symlink() and not link.exists():
        link.unlink()
    try:
        link.symlink_to(device)
    except OSError as error:
        raise PortUnavailable(f"{link}: {error.strerror}") from error
    try:
        yield
    finally:
        if link.is_symlink() and os.readlink(link) == device:
            link.unlink()


@contextlib.contextmanager
def _ending_signals() -> Iterator[int]:
    """A descriptor that becomes readable when the program is to end."""
    seen, written = os.pipe()
    os.set_blocking(written, False)
    kinds = (signal.SIGINT, signal.SIGTERM)
    before = {kind: signal.signal(kind, lambda *_: None) for kind in kinds}
    # Reading a terminal from the background is to fail instead of stopping the program.
    before[signal.SIGTTIN] = signal.signal(signal.SIGTTIN, signal.SIG_IGN)
    earlier = signal.set_wakeup_fd(written)
    try:
        yield seen
    finally:
        signal.set_wakeup_fd(earlier)
        for kind, handler in before.items():
            signal.signal(kind, handler)
        os.close(seen)
        os.close(written)
