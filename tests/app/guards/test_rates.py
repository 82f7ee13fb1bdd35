import itertools

from hypothesis import given
from hypothesis import strategies as st

from app.guards import rates
from app.guards.rates import RateLimiter


class Clock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


@given(
    rate=st.floats(0.1, 1000),
    burst=st.integers(1, 50),
    pauses=st.lists(st.floats(0, 5), max_size=60),
)
def test_no_span_of_time_has_more_than_its_share(
    rate: float, burst: int, pauses: list[float]
) -> None:
    clock = Clock()
    limiter = RateLimiter(rate, burst, monotonic=clock)
    granted = []
    for pause in pauses:
        clock.now_s += pause
        wait_s = limiter.take("a")
        assert wait_s >= 0
        if wait_s == 0:
            granted.append(clock.now_s)
    for first, last in itertools.combinations(range(len(granted)), 2):
        span = granted[last] - granted[first]
        assert last - first + 1 <= burst + span * rate + 1e-6


@given(rate=st.floats(0.1, 1000), burst=st.integers(1, 50))
def test_after_the_time_told_there_is_room(rate: float, burst: int) -> None:
    clock = Clock()
    limiter = RateLimiter(rate, burst, monotonic=clock)
    assert [limiter.take("a") for _ in range(burst)] == [0.0] * burst
    wait_s = limiter.take("a")
    assert 0 < wait_s <= 1 / rate
    assert limiter.take("b") == 0, "others pay for it"
    clock.now_s += wait_s + 1e-6
    assert limiter.take("a") == 0


def test_strangers_do_not_fill_the_memory() -> None:
    limiter = RateLimiter(1, 1)
    for number in range(rates.MOST_CLIENTS + 500):
        limiter.take(str(number))
    assert len(limiter._buckets) == rates.MOST_CLIENTS
    # Who was seen last is remembered.
    assert limiter.take(str(rates.MOST_CLIENTS + 499)) > 0
