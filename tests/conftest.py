"""Shared fixtures, and Hypothesis made reproducible."""

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numba
import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from bench.service.postgresql import INSTALL, PostgresqlServer, find_programs
from solver import Robot, load_robot

if TYPE_CHECKING:
    from tests.app.conftest import Server

# The device of real servos, for tests/contracts/test_bus.py. The service has a setting of that
# name, its HTTP port, so the services that tests start must not see it.
SERVO_PORT = os.environ.pop("PRUNUS_PORT", "")

if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
    # As compiled kernels do: a division by zero is infinite, without a warning.
    np.seterr(all="ignore")

# The same examples on every machine and in every run; kernels may compile on first use.
settings.register_profile(
    "reproducible",
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
settings.load_profile("reproducible")


@pytest.fixture(scope="session")
def tabletop() -> Robot:
    return load_robot("tabletop")


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator["Server"]:
    """A service that tests of routes and of documents share, as each start costs seconds."""
    from tests.app.conftest import BODY_LIMIT_BYTES, running_server  # other tests do without

    limit = str(BODY_LIMIT_BYTES)
    folder = tmp_path_factory.mktemp("service")
    with running_server(folder, PRUNUS_BODY_LIMIT_BYTES=limit) as it:
        yield it


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresqlServer]:
    """A PostgreSQL server that tests may also stop and start; it must run when they end."""
    programs = find_programs()
    if programs is None:
        # Where every change is tested nothing may go untested.
        tell = pytest.fail if os.environ.get("CI") == "true" else pytest.skip
        tell(f"PostgreSQL is not installed. {INSTALL}")
    server = PostgresqlServer.create(programs)
    yield server
    server.remove()


@pytest.fixture
def postgresql_url(postgresql: PostgresqlServer) -> str:
    """An empty PostgreSQL database of the test's own."""
    return postgresql.new_database()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What takes long begins first; else the order stays."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """A store that was not tested must not go unnoticed between dots."""
    if find_programs() is None:
        terminalreporter.section("PostgreSQL is not installed", red=True, bold=True)
        terminalreporter.line(f"Tests that need it were skipped, or failed with CI=true. {INSTALL}")
