import pytest

from app.schemas.demo_request import demo_request
from tests.app.reports.drawings.plans import FAR, Planned, planned


@pytest.fixture(scope="session")
def mixed() -> Planned:
    """Data set 3 with a target out of reach among the others."""
    request = demo_request()
    request["targets"].insert(1, FAR)
    return planned(request)


@pytest.fixture(scope="session")
def nothing_planned() -> Planned:
    return planned({**demo_request(), "targets": [FAR]})
