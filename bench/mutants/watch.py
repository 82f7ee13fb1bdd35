"""A plugin of pytest: how long each test takes, and an end for those that take too long.

Loaded by name, `-p bench.mutants.watch`; durations of what passed go to the file MUTANT_DURATIONS.
"""

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

MOST_S: Final = "MUTANT_MOST_S"
DURATIONS: Final = "MUTANT_DURATIONS"

_durations = pytest.StashKey[dict[str, float]]()


class TooLong(BaseException):
    """A test took too long; no test's own `except Exception` keeps it back."""


def pytest_configure(config: pytest.Config) -> None:
    """Nothing has run yet."""
    config.stash[_durations] = {}


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """End a test that takes too long."""

    def end(signum: int, frame: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, float(os.environ[MOST_S]))
    try:
        yield
    except TooLong:
        pytest.fail("it takes too long")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Keep how long what passes takes, with what it needs to be set up."""
    report: pytest.TestReport = yield  # type: ignore[assignment]
    durations = item.config.stash[_durations]
    if report.passed:
        durations[item.nodeid] = durations.get(item.nodeid, 0.0) + report.duration
    else:
        durations[item.nodeid] = float("inf")
    # At once: a run that takes too long as a whole is ended.
    Path(os.environ[DURATIONS]).write_text(json.dumps(durations))
    return report  # type: ignore[return-value]
