"""A batch solved in parts: what it decides as one, then its targets a few at a time.

Between two parts only a posture is kept, so a part may be solved in another process, and after a
restart: a batch of many targets tells how far it is, and goes on where it was.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task
from solver.kinematics.families.registry import family_of
from solver.methods.registry import METHODS
from solver.problem.problem import Problem
from solver.problem.solution import PLANNED, Approach, Arc
from solver.problem.targets import Target
from solver.sequencing.sequence import Stop, sequence
from solver.solving.many_targets import plan_many, plan_stops, plans_together
from solver.solving.one_target import plan_target


@dataclass(frozen=True)
class Choice:
    """What a batch decides as one.

    Attributes:
        order: ids of all targets in the order that they are planned in.
        stops: what was chosen for a target, by its id; empty where targets choose for themselves.
    """

    order: tuple[str, ...]
    stops: Mapping[str, Stop]


def choose(problem: Problem) -> Choice:
    """The order of a batch, and the approaches that its targets choose together."""
    given = tuple(target.id for target in problem.targets)
    optimal = problem.options.order == "optimal"
    if not (optimal or _as_one(problem)):
        return Choice(given, {})
    stops = {stop.task.target.id: stop for stop in sequence(problem)}
    # Targets that have no approach come last.
    chosen = (*stops, *(target_id for target_id in given if target_id not in stops))
    if _as_one(problem):
        return Choice(chosen if optimal else given, stops)
    # The order is good for approaches chosen together; going greedily it need not be.
    offers = [Choice(given, {}), Choice(chosen, {})]
    return min(offers, key=lambda choice: _refused_and_effort(problem, choice))


def plan_part(
    problem: Problem, choice: Choice, first: int, count: int, reference: Sequence[float]
) -> tuple[Approach, ...]:
    """The approaches of `count` targets of a batch from place `first` of its order.

    Args:
        problem: what was asked.
        choice: what `choose` answered for it.
        first: place in the order, from 0.
        count: how many; fewer at the end.
        reference: the problem's start for the first part, for another what `next_reference`
            answered for the one before, shape (joints,) [rad or m].
    """
    part = range(first, min(first + count, len(choice.order)))
    targets = [problem.targets_by_id[choice.order[place]] for place in part]
    together = _together(problem, choice, targets, reference)
    approaches: list[Approach] = []
    for place, target in zip(part, targets, strict=True):
        if target.id in together:
            approaches.append(together[target.id])
            reference = next_reference(problem, approaches[-1:], reference)
            continue
        stop = choice.stops.get(target.id)
        following = None if stop is None else _next_stop(choice, place)
        approach = plan_target(problem, target, reference, stop, following)
        approaches.append(approach)
        reference = next_reference(problem, (approach,), reference)
    return tuple(approaches)


def next_reference(
    problem: Problem, approaches: Sequence[Approach], reference: Sequence[float]
) -> tuple[float, ...]:
    """The posture that the next target's effort counts from, after these approaches."""
    if problem.options.order != "independent":
        for approach in reversed(approaches):
            if approach.status == PLANNED and approach.standby_joints is not None:
                return tuple(float(value) for value in approach.standby_joints)
    return tuple(float(value) for value in reference)


def in_answer_order(problem: Problem, approaches: Sequence[Approach]) -> tuple[Approach, ...]:
    """All approaches of a batch as they are answered: where the order is chosen, refused ones last.

    A target that was chosen can still fail to verify.
    """
    if problem.options.order != "optimal":
        return tuple(approaches)
    return tuple(sorted(approaches, key=lambda approach: approach.status != PLANNED))


def choice_to_json(choice: Choice) -> str:
    """A choice as text that `choice_from_json` reads again, to the last bit of every number."""
    # Almost all targets have the same rows, which are longer than all the rest of a stop.
    numbers: dict[tuple[float, ...], int] = {}
    stops = [
        {
            "id": target_id,
            "retreats": numbers.setdefault(stop.task.retreats_m, len(numbers)),
            "candidate": asdict(stop.candidate),
            "arc": asdict(stop.arc),
            "angle_rad": stop.angle_rad,
        }
        for target_id, stop in choice.stops.items()
    ]
    return json.dumps({"order": choice.order, "retreats_m": list(numbers), "stops": stops})


def choice_from_json(problem: Problem, text: str) -> Choice:
    """The choice for a problem that `choice_to_json` wrote."""
    read = json.loads(text)
    retreats_m = [tuple(rows) for rows in read["retreats_m"]]

    def stop(entry: Mapping[str, Any]) -> Stop:
        task = approach_task(problem, problem.targets_by_id[entry["id"]], problem.start)
        candidate = Candidate(**entry["candidate"])
        return Stop(
            replace(task, retreats_m=retreats_m[entry["retreats"]]),
            replace(candidate, thinning_joints=tuple(candidate.thinning_joints), others=()),
            Arc(**entry["arc"]),
            entry["angle_rad"],
        )

    return Choice(tuple(read["order"]), {entry["id"]: stop(entry) for entry in read["stops"]})


def _together(
    problem: Problem, choice: Choice, targets: Sequence[Target], reference: Sequence[float]
) -> dict[str, Approach]:
    """What can be planned without going from target to target, by target id."""
    if not plans_together(problem):
        return {}
    if problem.options.order == "independent":
        return plan_many(problem, targets)
    stops = [choice.stops[target.id] for target in targets if target.id in choice.stops]
    return plan_stops(problem, stops, reference)


def _as_one(problem: Problem) -> bool:
    """Whether approaches are chosen for the batch and not for each target."""
    options = problem.options
    return (
        options.order != "independent"
        and METHODS[options.method].chooses_among_arcs
        and family_of(problem.robot, problem.mounted_tool).has_closed_form
    )


def _next_stop(choice: Choice, place: int) -> Stop | None:
    following = (choice.stops.get(target_id) for target_id in choice.order[place + 1 :])
    return next((stop for stop in following if stop is not None), None)


def _refused_and_effort(problem: Problem, choice: Choice) -> tuple[int, float]:
    approaches = plan_part(problem, choice, 0, len(choice.order), problem.start)
    efforts = [approach.effort or 0.0 for approach in approaches]
    return sum(approach.status != PLANNED for approach in approaches), sum(efforts)
