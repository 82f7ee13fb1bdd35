from itertools import pairwise

import pytest

from solver.comparison.contest import Account
from solver.comparison.scenarios.sample_counts import STARTS, own, sample_counts_contest
from tests.solver.comparison.scenarios.accounts import Accounts, accounts


@pytest.fixture(scope="module")
def sampled() -> Accounts:
    return accounts(sample_counts_contest(None))


def failures(found: dict[str, list[Account]]) -> int:
    return sum(not account.solved for starts in found.values() for account in starts)


def widest_spread(found: dict[str, list[Account]]) -> float:
    spreads = []
    for starts in found.values():
        efforts = [account.index for account in starts if account.index is not None]
        spreads.append(max(efforts) - min(efforts) if efforts else 0.0)
    return max(spreads)


def test_few_angles_fail_where_there_is_little_room(sampled: Accounts) -> None:
    """T 4.3.2; on its own data set, from one start posture, no number of angles fails."""
    failed = [failures(own(sampled, f"floating_z n={n}", narrow=True)) for n in (10, 50)]
    assert failed[0] > failed[1] > 0
    assert failures(own(sampled, "ncos", narrow=True)) == 0
    for n in (10, 20, 30, 40, 50):
        assert failures(own(sampled, f"floating_z n={n}", narrow=False)) == 0


def test_more_angles_repeat_better(sampled: Accounts) -> None:
    found = {n: own(sampled, f"floating_z n={n}", narrow=False) for n in (10, 20, 50)}
    assert all(
        len(starts) == STARTS for by_target in found.values() for starts in by_target.values()
    )
    spreads = [widest_spread(by_target) for by_target in found.values()]
    assert all(one > two for one, two in pairwise(spreads))
    assert widest_spread(own(sampled, "ncos", narrow=False)) == 0.0


def test_findings_say_it(sampled: Accounts) -> None:
    contest = sample_counts_contest(None)
    assert contest.findings is not None
    found = contest.findings(sampled)
    assert len(found) == len(contest.entrants)
    assert found[-1].startswith("ncos: 0 of 100 failed")
