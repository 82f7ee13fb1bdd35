from solver.comparison.scenarios.fixed_or_floating import (
    fixed_or_floating_contest,
    fixed_or_floating_problem,
)
from tests.solver.comparison.scenarios.accounts import accounts


def test_the_floating_axis_reaches_more() -> None:
    contest = fixed_or_floating_contest(None)
    found = accounts(contest)

    def reached(name: str) -> int:
        return sum(account.solved for (_, entrant), account in found.items() if entrant == name)

    assert 0 < reached("fixed_z") < reached("floating_z") <= reached("ncos")
    assert contest.findings is not None
    assert f"fixed_z reaches {reached('fixed_z')} targets." in contest.findings(found)
    alone = fixed_or_floating_contest(["fixed_z"])
    assert alone.findings is not None
    own_accounts = {key: value for key, value in found.items() if key[1] == "fixed_z"}
    assert len(alone.findings(own_accounts)) == 1


def test_branches_suit_the_fixed_z_axis() -> None:
    problem = fixed_or_floating_problem(3, 20)
    assert len(problem.targets) == 20
    assert all(target.branch_direction[0] == 0.0 for target in problem.targets)
