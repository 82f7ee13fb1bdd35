"""Shared fixtures, and Hypothesis made reproducible."""

import os

import pytest
from hypothesis import HealthCheck, settings

from solver import Robot, load_robot

# The device of real servos, for tests/contracts/test_bus.py. The service has a setting of that
# name, its HTTP port, so the services that tests start must not see it.
SERVO_PORT = os.environ.pop("PRUNUS_PORT", "")

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
