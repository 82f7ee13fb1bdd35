from dataclasses import replace

from solver import Options, Problem, Robot, solve
from solver.solving.proposal import judged
from solver.verification.verify import verify
from tests.solver.problems import random_targets


def test_a_refuted_displacement_margin_is_claimed_no_more(tabletop: Robot) -> None:
    """The approach itself is as good as it was."""
    options = Options(method="ssas", order="independent", include=("path",))
    problem = Problem(tabletop, random_targets(seed=46, count=60), options=options)
    lowered = 0
    for approach in solve(problem).approaches:
        if not approach.displacement_margin_m or approach.displacement_margin_m < 1e-3:
            continue
        for factor in (3.0, 1e4):
            more = replace(approach, displacement_margin_m=factor * approach.displacement_margin_m)
            assert not verify(problem, more, problem.start).accepted
            again = judged(problem, more, problem.start)
            assert again.status == "planned"
            assert again.displacement_margin_m is not None
            assert again.displacement_margin_m <= 1.1 * approach.displacement_margin_m
            lowered += 1
    assert lowered >= 10
