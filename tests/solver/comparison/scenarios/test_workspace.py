from solver.comparison.scenarios.workspace import workspace_problem
from tests.solver.comparison.scenarios.accounts import widest_arcs_rad


def test_workspace_targets_have_arcs() -> None:
    assert workspace_problem(3, 20).targets != workspace_problem(4, 20).targets
    found = widest_arcs_rad(workspace_problem(3, 20))
    assert len(found) == 20
    assert min(found) > 0
