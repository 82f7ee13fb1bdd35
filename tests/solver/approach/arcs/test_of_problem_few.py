"""The arcs of two targets of a problem, one of them uncertain."""

from dataclasses import replace

from solver.approach.arcs.arcs import task_arcs
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.task.task import approach_task
from tests.solver.methods.synthetic import problem_of


def test_each_target_has_its_arcs_by_its_id() -> None:
    problem = problem_of(symmetric_tool=True)
    far = replace(problem.targets[1], position_m=(9.0, 0.0, 0.0))
    sure, far_one = problem.targets[2], replace(far, id="far")
    unsure = replace(problem.targets[4], id="unsure", position_std_m=0.002)
    some = replace(problem, targets=(sure, far_one, unsure))
    found = feasible_arcs(some)
    assert list(found) == [sure.id, "far", "unsure"]
    assert found["far"] == ()
    for target in (sure, unsure):
        alone = task_arcs(approach_task(some, target, some.start))
        assert sorted(map(repr, found[target.id])) == sorted(map(repr, alone))
        assert alone
    assert any("uncertainty" in (a.lower_limit, a.upper_limit) for a in found["unsure"])
    assert not any("uncertainty" in (a.lower_limit, a.upper_limit) for a in found[sure.id])
    assert {arc.tool_side for arc in (*found[sure.id], *found["unsure"])} <= {1, -1}
