"""What is known of the methods by their names."""

import pytest

from solver.methods.ncos import improved_in_chain
from solver.methods.registry import METHODS
from solver.problem.options import METHOD_NAMES


def test_every_method_that_an_option_names_has_a_row_of_its_name() -> None:
    assert tuple(METHODS) == METHOD_NAMES
    for name, row in METHODS.items():
        assert row.name == name
        assert row.summary


@pytest.mark.parametrize(
    ("name", "part", "among_arcs", "is_optimum", "starts_cold"),
    [
        ("fixed_z", 100, False, False, False),
        ("floating_z", 100, False, False, False),
        ("as", 100, False, False, False),
        ("ssas", 250, True, True, False),
        ("ncos", 50, True, False, True),
    ],
)
def test_rows(name: str, part: int, among_arcs: bool, is_optimum: bool, starts_cold: bool) -> None:
    """Only methods that choose among arcs are planned as one; only the programme starts cold."""
    row = METHODS[name]  # type: ignore[index]
    assert row.targets_in_a_part == part
    assert row.chooses_among_arcs is among_arcs
    assert row.is_arc_optimum is is_optimum
    assert row.starts_cold is starts_cold
    assert row.improve is (improved_in_chain if name == "ncos" else None)
