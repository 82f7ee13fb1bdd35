"""Robot time: the wall clock's, or faster when the servos are simulated to be."""

import time
from collections.abc import Callable
from datetime import UTC, datetime


class RobotClock:
    """Monotonic seconds that pass `factor` times as fast as the wall clock's."""

    def __init__(
        self,
        factor: float = 1.0,
        *,
        monotonic: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.factor = factor
        self._monotonic = monotonic
        self._sleep = sleep

    def now(self) -> float:
        """Robot time [s]."""
        return self._monotonic() * self.factor

    def sleep(self, robot_s: float) -> None:
        """Wait for so long in robot time; not at all if that is not above zero."""
        if robot_s > 0:
            self._sleep(robot_s / self.factor)


def timestamp() -> str:
    """This instant as RFC 3339 text in UTC, to the millisecond."""
    return instant_text(datetime.now(UTC))


def instant_text(instant: datetime) -> str:
    """An instant in UTC as RFC 3339 text, to the millisecond."""
    return instant.isoformat(timespec="milliseconds").replace("+00:00", "Z")
