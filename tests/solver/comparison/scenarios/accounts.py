"""What is asked of several scenarios: their entrants' accounts, and how much room there is."""

from solver import Problem, feasible_arcs
from solver.comparison.contest import Account, Contest

Accounts = dict[tuple[str, str], Account]


def accounts(contest: Contest) -> Accounts:
    return {
        (target, entrant.name): contest.account(entrant.name, k, entrant.solve(k))
        for entrant in contest.entrants
        for k, target in enumerate(contest.target_ids)
    }


def widest_arcs_rad(problem: Problem) -> list[float]:
    return [
        max((arc.upper_rad - arc.lower_rad for arc in arcs), default=-1.0)
        for arcs in feasible_arcs(problem).values()
    ]
