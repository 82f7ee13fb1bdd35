"""The scenarios, one row each. Adding one is a file in `solver/comparison/scenarios` and a row here."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from solver.comparison.contest import Contest, with_entrants
from solver.comparison.scenarios.data_sets import (
    data_set_1_contest,
    data_set_2_contest,
    data_set_3_contest,
)
from solver.comparison.scenarios.strawberry import strawberry_contest
from solver.exceptions import UnknownScenario


@dataclass(frozen=True)
class Scenario:
    """Targets on which methods are compared.

    Attributes:
        name: what the command and requests call it.
        title: a line for people.
        contest: the scenario made ready, with the entrants of these names, or its own choice for
            None. Raises UnknownEntrant for other names.
    """

    name: str
    title: str
    contest: Callable[[Sequence[str] | None], Contest]


_ROWS = (
    Scenario("data-set-1", "the thesis's horizontal branch, reconstructed", data_set_1_contest),
    Scenario("data-set-2", "the thesis's leaning branch, reconstructed", data_set_2_contest),
    Scenario("data-set-3", "the thesis's branch in space", data_set_3_contest),
    Scenario(
        "strawberry",
        "the strawberry paper's mechanism, 20 targets",
        lambda names: with_entrants(strawberry_contest(), names),
    ),
)

SCENARIOS: Final[Mapping[str, Scenario]] = MappingProxyType({row.name: row for row in _ROWS})


def find_scenario(name: str) -> Scenario:
    """The scenario of a name.

    Raises:
        UnknownScenario: there is none.
    """
    if name not in SCENARIOS:
        raise UnknownScenario(name, known=tuple(SCENARIOS))
    return SCENARIOS[name]
