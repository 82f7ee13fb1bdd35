"""How many requests a client may make: a token bucket each."""

import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Final

MOST_CLIENTS: Final = 10_000
"""More than these are not told apart from new ones; each costs about 200 bytes."""


class RateLimiter:
    """Buckets that fill at a rate up to a burst; a request takes one drop.

    Args:
        rate_per_s: drops that come to each bucket [1/s].
        burst: drops in a full bucket; a new client has so many.
        monotonic: a clock that never steps [s].
    """

    def __init__(
        self, rate_per_s: float, burst: int, *, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self._rate_per_s = rate_per_s
        self._burst = burst
        self._monotonic = monotonic
        # Drops left and when they were counted, the client that was seen last at the end.
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, client: str) -> float:
        """Take a drop: 0 if there was one, else in how many seconds there will be."""
        now = self._monotonic()
        left, counted_at = self._buckets.get(client, (float(self._burst), now))
        left = min(self._burst, left + (now - counted_at) * self._rate_per_s)
        granted = left >= 1
        self._buckets[client] = (left - 1 if granted else left, now)
        self._buckets.move_to_end(client)
        if len(self._buckets) > MOST_CLIENTS:
            self._buckets.popitem(last=False)
        return 0.0 if granted else (1 - left) / self._rate_per_s
