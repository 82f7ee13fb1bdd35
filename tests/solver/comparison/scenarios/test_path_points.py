from itertools import pairwise

import numpy as np

from solver.comparison.approach_contest import BETWEEN_ROWS
from solver.comparison.scenarios.path_points import COUNTS, EQUAL_SPEED, path_points_contest
from tests.solver.comparison.scenarios.accounts import accounts


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
