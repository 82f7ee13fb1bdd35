import pytest

from solver.comparison.scenarios.near_limits import NARROW_RAD, near_limits_problem
from tests.solver.comparison.scenarios.accounts import widest_arcs_rad


def test_near_limits_targets_have_narrow_arcs_only() -> None:
    found = widest_arcs_rad(near_limits_problem(3, 20))
    assert len(found) == 20
    assert min(found) > 0
    assert max(found) <= NARROW_RAD


def test_too_few_targets_are_no_scenario(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.comparison.scenarios.near_limits.NARROW_RAD", 1e-9)
    with pytest.raises(ValueError, match="narrow"):
        near_limits_problem(3, 20)
