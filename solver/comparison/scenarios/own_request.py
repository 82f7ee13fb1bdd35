"""A plan request of one's own as a contest."""

from collections.abc import Sequence

from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Contest
from solver.problem.problem import Problem


def request_contest(problem: Problem, name: str, methods: Sequence[str] | None = None) -> Contest:
    """The contest of methods on the targets, arm, tool and options of a request.

    Args:
        problem: what the request asks for; its own method does not matter.
        name: what the contest is called, such as the file's name.
        methods: None: all of them.

    Raises:
        UnknownEntrant: there is no such method.
        InvalidProblem: an option that the request has cannot be compared with all methods.
    """
    return approach_contest(
        problem,
        chosen(method_variants(problem), methods),
        scenario=name,
        title=f"{len(problem.targets)} targets of a request for {problem.robot.name}",
        origin="A request's targets, tool, start posture and options.",
        notes=(
            "Every target is planned on its own, from the start posture, whatever the request's "
            "order; motion is not timed.",
        ),
        seeds=(problem.options.seed,),
    )
