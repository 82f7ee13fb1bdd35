"""Shared fixtures, and Hypothesis made reproducible."""

import pytest
from hypothesis import HealthCheck, settings

from solver import Robot, load_robot

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
