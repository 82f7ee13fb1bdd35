"""What goes out over one robot link, and in which order."""

import asyncio
from collections import deque
from collections.abc import Iterable
from typing import Final

from hardware.link.messages import HEARTBEAT_S, FromService, Heartbeat, encode

ORDER_BYTES_PER_S: Final = 4 * 1024 * 1024
"""Orders are sent no faster than a worker reads them. Otherwise megabytes of motion would lie in
the buffers of the operating systems, where no stop can overtake them."""


class Outbox:
    """Urgent messages first, heartbeats in between, orders when nothing else waits.

    An order is an execution with all its motions. What of it has not been taken yet can be
    withdrawn, and a worker never begins an order that it has not got in full.
    """

    def __init__(self) -> None:
        self._urgent: deque[str] = deque()
        self._order: deque[str] = deque()
        self._changed = asyncio.Event()
        self._heartbeat_due = self._order_due = _now()

    def send(self, message: FromService) -> None:
        """Send ahead of everything but what is urgent too."""
        self._urgent.append(encode(message))
        self._changed.set()

    def hand_over(self, order: Iterable[str]) -> None:
        """Send the messages of an order, one after the other."""
        self._order.extend(order)
        self._changed.set()

    def withdraw(self) -> bool:
        """Drop what is left of the order; whether anything was."""
        left = bool(self._order)
        self._order.clear()
        return left

    async def take(self) -> str:
        """The next message to send, as soon as there is one."""
        while True:
            now = _now()
            if self._urgent:
                return self._urgent.popleft()
            if now >= self._heartbeat_due:
                self._heartbeat_due = now + HEARTBEAT_S
                return encode(Heartbeat())
            if self._order and now >= self._order_due:
                text = self._order.popleft()
                self._order_due = now + len(text) / ORDER_BYTES_PER_S
                return text
            due = min(self._heartbeat_due, self._order_due) if self._order else self._heartbeat_due
            self._changed.clear()
            try:
                async with asyncio.timeout(due - now):
                    await self._changed.wait()
            except TimeoutError:
                continue


def _now() -> float:
    return asyncio.get_running_loop().time()
