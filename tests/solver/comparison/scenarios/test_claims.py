"""The scenarios that put the thesis's claims to the test, and what they find."""

from itertools import pairwise

import numpy as np
import pytest

from solver.comparison.approach_contest import BETWEEN_ROWS
from solver.comparison.contest import Account, Contest
from solver.comparison.scenarios.fixed_or_floating import fixed_or_floating_contest
from solver.comparison.scenarios.path_points import COUNTS, EQUAL_SPEED, path_points_contest
from solver.comparison.scenarios.sample_counts import STARTS, own, sample_counts_contest

Accounts = dict[tuple[str, str], Account]


def accounts(contest: Contest) -> Accounts:
    return {
        (target, entrant.name): contest.account(entrant.name, k, entrant.solve(k))
        for entrant in contest.entrants
        for k, target in enumerate(contest.target_ids)
    }


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


def test_more_points_are_straighter() -> None:
    contest = path_points_contest(None)
    found = accounts(contest)
    worst: dict[str, list[float]] = {BETWEEN_ROWS: [], EQUAL_SPEED: []}
    for entrant in contest.entrants:
        own_accounts = [found[target, entrant.name] for target in contest.target_ids]
        assert all(account.solved for account in own_accounts)
        for what, values in worst.items():
            values.append(max(account.residuals[what] for account in own_accounts))
    assert len(contest.entrants) == len(COUNTS)
    for values in worst.values():
        assert all(one > two for one, two in pairwise(values))
    # Motors at one speed, as T's, leave the line much further than joints that arrive together.
    assert np.all(np.array(worst[EQUAL_SPEED]) > 10 * np.array(worst[BETWEEN_ROWS]))
    assert contest.findings is not None
    assert len(contest.findings(found)) == len(COUNTS)


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
