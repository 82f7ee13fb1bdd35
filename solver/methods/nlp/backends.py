"""The backends: what solves a programme, one row each."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, Protocol

from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.nlp.ipopt import solve_by_ipopt
from solver.methods.nlp.sqp import solve_by_sqp
from solver.problem.options import Options
from solver.robots.model import Robot


class Backend(Protocol):
    """Solves a programme from its start; no answer of it is verified yet."""

    def __call__(self, robot: Robot, instance: Instance, options: Options) -> ProgrammeResult:
        """The result, its budget counted in iterations; failures are a status, never raised."""
        ...


def _sqp(robot: Robot, instance: Instance, options: Options) -> ProgrammeResult:
    return solve_by_sqp(robot, instance, options.qp_solver)


def _ipopt(robot: Robot, instance: Instance, options: Options) -> ProgrammeResult:
    return solve_by_ipopt(robot, instance)


BACKENDS: Final[Mapping[str, Backend]] = MappingProxyType({"sqp": _sqp, "ipopt": _ipopt})


def solve_instance(robot: Robot, instance: Instance, options: Options) -> ProgrammeResult:
    """Solves a programme by the backend that the options name."""
    return BACKENDS[options.nlp_backend](robot, instance, options)
