import pytest

from solver import Options, Robot
from solver.comparison.scenarios.own_request import request_contest
from solver.exceptions import UnknownEntrant
from solver.methods.registry import METHODS
from tests.solver.problems import data_set_3


def test_request_is_compared_as_it_is(tabletop: Robot) -> None:
    problem = data_set_3(tabletop, order="given", norm="l2", method="as", certify=True, seed=5)
    contest = request_contest(problem, "mine.json")
    assert contest.scenario == "mine.json"
    assert [entrant.name for entrant in contest.entrants] == list(METHODS)
    assert contest.target_ids == tuple("12345")
    assert contest.problem is not None
    options: Options = contest.problem.options
    assert (options.norm, options.order, options.seed) == ("l2", "independent", 5)
    assert contest.seeds == (5,)
    assert any("order" in note for note in contest.notes)
    assert contest.account("ncos", 0, contest.entrants[-1].solve(0)).solved


def test_methods_are_chosen(tabletop: Robot) -> None:
    contest = request_contest(data_set_3(tabletop), "mine.json", ["ncos"])
    assert [entrant.name for entrant in contest.entrants] == ["ncos"]
    with pytest.raises(UnknownEntrant):
        request_contest(data_set_3(tabletop), "mine.json", ["nothing"])
