"""The subjects, a row each."""

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from bench.measure import Row

ONE_CORE: Final = 1
ALL_CORES: Final = 0


@dataclass(frozen=True)
class Subject:
    """One subject.

    Attributes:
        name: on the command line, of its file in `bench/subjects` and of its results.
        title: for people.
        cores: how many it may use; ALL_CORES or a number.
        target: what make calls it, if it is none of `make bench`.
    """

    name: str
    title: str
    cores: int = ONE_CORE
    target: str = ""

    @property
    def command(self) -> str:
        """What measures it."""
        return f"make {self.target or f'bench ONLY={self.name}'}"

    @property
    def measure(self) -> Callable[[bool], list[Row]]:
        """Takes whether it has to be quick; gives the lines of the report."""
        module = importlib.import_module(f"bench.subjects.{self.name}")
        measure: Callable[[bool], list[Row]] = module.measure
        return measure


_ALL = (
    Subject("closed_form", "Closed form"),
    Subject("ssas", "`ssas` with its cut-ins, against sweeps by others"),
    Subject("sweep_share", "Against a sweep of 65,536 angles", ALL_CORES),
    Subject("ncos", "`ncos` without relaxations"),
    Subject("relaxed", "`ncos` with a strike zone and a tilt"),
    Subject("more_room", "More room against less"),
    Subject("cold_starts", "What the warm start is worth"),
    Subject("position_margin", "A millimetre of freedom"),
    Subject("given", "Order `given`, against ladder graphs"),
    Subject("optimal", "Order `optimal`, against longer searches"),
    Subject("savings", "Effort saved"),
    Subject("certificate", "Proven bounds"),
    Subject("refusals", "Refusals explained"),
    Subject("clearance", "What touches"),
    Subject("large_batch", "100,000 targets"),
    Subject("second_process", "Start of a second process"),
    Subject("thesis", "Beside the thesis: data set 3"),
)

SUBJECTS: Final[Mapping[str, Subject]] = MappingProxyType({one.name: one for one in _ALL})

# A live server in a process of its own; hours together. See `bench.service`.
SERVICE: Final = Subject("service", "The service under load", ALL_CORES, "bench-service")
_LIVE = (ALL_CORES, SERVICE.target)
FUZZING: Final = Subject("fuzzing", "The service against its description", *_LIVE)
KILLS: Final = Subject("kills", "The service killed under load", *_LIVE)

SHOWN: Final = (*_ALL, SERVICE, FUZZING, KILLS)
"""What docs/benchmarks.md has."""
