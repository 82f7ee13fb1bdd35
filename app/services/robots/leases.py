"""Leases: who controls a robot for a while, so that two clients do not take turns moving it.

They are kept in memory: after a restart nobody has one, and every execution has ended too. What a
lease protects is starting and changing executions. It is no watchdog: an execution goes on when
its lease expires, because the worker carries it out by itself and an arm that stops half-way among
branches, over a network that drops, is worse than one that ends what it was told to do.
"""

import hmac
import math
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

from app.schemas.leases import LEASE_HEADER
from app.services.exceptions import Conflict, NotFound
from app.services.idempotency import key_reused
from app.store import NewKey
from hardware.clock import instant_text


@dataclass(frozen=True)
class Lease:
    """A robot's lease.

    Attributes:
        id: whoever knows it has the lease.
        robot: the robot's name.
        holder: who has it, in their own words.
        duration_s: how long it lasts from when it was given or renewed.
        expires_at: when it ends, RFC 3339, for people.
        ends: when it ends, on the service's own clock [s].
        key: that it was asked for under, if any.
    """

    id: str
    robot: str
    holder: str
    duration_s: float
    expires_at: str
    ends: float
    key: NewKey | None = None


class LeaseService:
    """The leases by robot. It lives on the event loop and is used there only."""

    def __init__(self, *, monotonic: Callable[[], float] = time.monotonic) -> None:
        self._monotonic = monotonic
        self._leases: dict[str, Lease] = {}

    def current(self, robot: str) -> Lease | None:
        """The robot's lease that is valid now."""
        lease = self._leases.get(robot)
        if lease is not None and lease.ends <= self._monotonic():
            del self._leases[robot]
            return None
        return lease

    def take(self, robot: str, holder: str, duration_s: float, key: NewKey | None = None) -> Lease:
        """A new lease of a robot that nobody has, or the one that was given under the same key.

        Raises:
            Conflict: somebody has it.
            InvalidRequest: the key stands for another body.
        """
        lease = self.current(robot)
        if lease is None:
            return self._keep(Lease(uuid.uuid4().hex, robot, holder, duration_s, "", 0.0, key))
        known = lease.key
        if key is None or known is None or (key.scope, key.key) != (known.scope, known.key):
            raise self._leased(robot, "The robot is leased to another client.")
        if key.digest != known.digest:
            raise key_reused()
        return lease

    def renew(self, robot: str, lease_id: str, duration_s: float | None) -> Lease:
        """The same lease from now on, for as long as before or for another duration.

        Raises:
            NotFound: there is no such lease any more.
        """
        lease = self._own(robot, lease_id)
        return self._keep(replace(lease, duration_s=duration_s or lease.duration_s))

    def give_back(self, robot: str, lease_id: str) -> None:
        """End a lease.

        Raises:
            NotFound: there is no such lease any more.
        """
        del self._leases[self._own(robot, lease_id).robot]

    def check(self, robot: str, lease_id: str) -> None:
        """See to it that nobody has a lease of the robot but this one.

        Raises:
            Conflict: somebody has.
        """
        lease = self.current(robot)
        if lease is None or _same(lease.id, lease_id):
            return
        detail = f"The robot is leased; only requests with its {LEASE_HEADER} may move it."
        raise self._leased(robot, detail)

    def _own(self, robot: str, lease_id: str) -> Lease:
        lease = self.current(robot)
        if lease is None or not _same(lease.id, lease_id):
            detail = "There is no lease of this id; it may have expired."
            raise NotFound("not_found", detail)
        return lease

    def _keep(self, lease: Lease) -> Lease:
        until = datetime.now(UTC) + timedelta(seconds=lease.duration_s)
        lease = replace(
            lease,
            expires_at=instant_text(until),
            ends=self._monotonic() + lease.duration_s,
        )
        self._leases[lease.robot] = lease
        return lease

    def _leased(self, robot: str, detail: str) -> Conflict:
        wait_s = self._leases[robot].ends - self._monotonic()
        return Conflict("leased", detail, retry_after_s=max(1, math.ceil(wait_s)))


def _same(kept: str, sent: str) -> bool:
    return hmac.compare_digest(kept.encode(), sent.encode(errors="replace"))
