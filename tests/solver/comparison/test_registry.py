from collections import Counter

import pytest

from solver.comparison.contest import Account, Contest
from solver.comparison.registry import SCENARIOS, find_scenario
from solver.exceptions import UnknownEntrant, UnknownScenario
from solver.methods.registry import METHODS

REACHED_BY_ALL_PLACES = ("workspace", "near-limits", "data-set-1", "data-set-2", "data-set-3")


def contest_of(name: str) -> Contest:
    return SCENARIOS[name].contest(None)


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenario_is_whole(name: str) -> None:
    contest = contest_of(name)
    assert contest.scenario == name
    assert contest.title
    assert contest.origin
    assert contest.index_name
    assert len(set(contest.target_ids)) == len(contest.target_ids) > 0
    names = [entrant.name for entrant in contest.entrants]
    assert max(Counter(names).values()) == 1
    assert contest.reference in names
    assert {method for _, method in contest.published} <= set(names)
    assert {target for target, _ in contest.published} <= set(contest.target_ids)


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenario_is_the_same_every_time(name: str) -> None:
    one, two = contest_of(name), contest_of(name)
    assert one.target_ids == two.target_ids
    if one.problem is not None and two.problem is not None:
        assert one.problem.targets == two.problem.targets


@pytest.mark.parametrize("name", SCENARIOS)
def test_entrants_are_chosen_by_name(name: str) -> None:
    last = contest_of(name).entrants[-1].name
    contest = SCENARIOS[name].contest([last])
    assert [entrant.name for entrant in contest.entrants] == [last]
    with pytest.raises(UnknownEntrant) as caught:
        SCENARIOS[name].contest(["newton"])
    assert last in caught.value.known


def test_unknown_scenario_is_misuse() -> None:
    with pytest.raises(UnknownScenario) as caught:
        find_scenario("data-set-4")
    assert caught.value.known == tuple(SCENARIOS)
    assert find_scenario("data-set-3") is SCENARIOS["data-set-3"]


@pytest.mark.parametrize("name", REACHED_BY_ALL_PLACES)
def test_every_target_has_an_approach(name: str) -> None:
    contest = SCENARIOS[name].contest(["ssas"])
    (ssas,) = contest.entrants
    accounts: list[Account] = [
        contest.account("ssas", k, ssas.solve(k)) for k in range(len(contest.target_ids))
    ]
    assert all(account.solved for account in accounts)


def test_methods_compete_in_the_thesis_scenarios() -> None:
    for name in ("data-set-1", "data-set-2", "data-set-3", "workspace", "near-limits", "kac-v"):
        assert [entrant.name for entrant in contest_of(name).entrants] == list(METHODS)
