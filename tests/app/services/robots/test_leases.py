"""Leases by themselves; test_access.py has them over HTTP."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.services.exceptions import ServiceError
from app.services.robots.leases import LeaseService
from app.store import NewKey


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def refused(code: str) -> "pytest.RaisesExc[ServiceError]":
    return pytest.raises(ServiceError, check=lambda error: error.code == code)


@given(duration=st.floats(1, 300), share=st.floats(0, 0.999))
def test_a_lease_holds_until_it_expires_and_no_longer(duration: float, share: float) -> None:
    clock = Clock()
    leases = LeaseService(monotonic=clock)
    lease = leases.take("arm", "a", duration)
    clock.now_s = duration * share
    leases.check("arm", lease.id)
    for wrong in ("", "0" * 32, lease.id[:-1], "é\ud800"):
        with refused("leased") as raised:
            leases.check("arm", wrong)
        retry_s = raised.value.retry_after_s
        assert retry_s is not None
        # Whoever waits as told finds it free.
        assert duration - clock.now_s <= max(retry_s, 1)
        assert retry_s < duration - clock.now_s + 1.0001
    with refused("leased"):
        leases.take("arm", "b", 1)
    leases.check("other arm", "")
    clock.now_s = duration
    assert leases.current("arm") is None
    leases.check("arm", "")
    with refused("not_found"):
        leases.renew("arm", lease.id, None)
    with refused("not_found"):
        leases.give_back("arm", lease.id)
    assert leases.take("arm", "b", 1).id != lease.id


def test_renewing_starts_its_time_again() -> None:
    clock = Clock()
    leases = LeaseService(monotonic=clock)
    lease = leases.take("arm", "a", 10)
    clock.now_s = 9
    assert leases.renew("arm", lease.id, None).id == lease.id
    clock.now_s = 18
    assert leases.current("arm") is not None
    renewed = leases.renew("arm", lease.id, 2)
    assert (renewed.duration_s, renewed.holder) == (2, "a")
    clock.now_s = 20
    assert leases.current("arm") is None


def test_only_its_holder_gives_it_back() -> None:
    leases = LeaseService(monotonic=Clock())
    lease = leases.take("arm", "a", 10)
    for wrong in ("", "x"):
        with refused("not_found"):
            leases.give_back("arm", wrong)
    with refused("not_found"):
        leases.give_back("other arm", lease.id)
    assert leases.current("arm") is not None
    leases.give_back("arm", lease.id)
    assert leases.current("arm") is None
    leases.check("arm", "")


def test_a_key_gives_the_same_lease_as_long_as_it_lasts() -> None:
    clock = Clock()
    leases = LeaseService(monotonic=clock)
    key, other = NewKey("POST arm", "k", "1"), NewKey("POST arm", "other", "1")
    lease = leases.take("arm", "a", 10, key)
    clock.now_s = 9
    assert leases.take("arm", "a", 10, key) is lease
    renewed = leases.renew("arm", lease.id, None)
    assert leases.take("arm", "a", 10, key) is renewed
    with refused("idempotency_key_reused"):
        leases.take("arm", "b", 10, NewKey("POST arm", "k", "2"))
    for wrong in (None, other, NewKey("somebody else", "k", "1")):
        with refused("leased"):
            leases.take("arm", "a", 10, wrong)
    clock.now_s = 20
    assert leases.take("arm", "a", 10, key).id != lease.id
