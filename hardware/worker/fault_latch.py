"""Faults, kept until somebody acknowledges them."""

import logging

from hardware.clock import timestamp
from hardware.exceptions import HardwareError, JointError, ServoError
from hardware.link.messages import Failure

logger = logging.getLogger(__name__)


class FaultLatch:
    """What went wrong since the last acknowledgement, the first first."""

    def __init__(self) -> None:
        self._failures: dict[tuple[str, str], Failure] = {}

    def __bool__(self) -> bool:
        return bool(self._failures)

    def __contains__(self, error: HardwareError) -> bool:
        """Whether the same thing went wrong before; numbers in its text may have changed."""
        return _subject(error) in self._failures

    @property
    def failures(self) -> tuple[Failure, ...]:
        """All of them."""
        return tuple(self._failures.values())

    @property
    def codes(self) -> tuple[str, ...]:
        """Their codes."""
        return tuple(failure.code for failure in self._failures.values())

    def latch(self, error: HardwareError, trouble: tuple[str, ...] = ()) -> None:
        """Keep an error, with what else went wrong over it; of one thing the first stays."""
        if error not in self:
            detail = "; ".join((error.detail, *trouble))
            logger.error("%s: %s", error.code, detail)
            self._failures[_subject(error)] = Failure(error.code, detail, timestamp())

    def clear(self) -> None:
        """Somebody has seen them."""
        self._failures.clear()


def _subject(error: HardwareError) -> tuple[str, str]:
    match error:
        case ServoError():
            return error.code, str(error.servo_id)
        case JointError():
            return error.code, error.joint
    return error.code, ""
