"""A scenario made ready to run: what every method of it is given, and how its answer is judged.

What is timed (`Entrant.solve`) is apart from what judges it (`Contest.account`), so that no method
pays for the verifier and none is believed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from solver.exceptions import UnknownEntrant
from solver.problem.problem import Problem


@dataclass(frozen=True)
class Published:
    """What a document prints for one target and method; None where it prints nothing."""

    index: float | None = None
    time_s: float | None = None


@dataclass(frozen=True)
class Account:
    """One answer as the verifier found it.

    Attributes:
        solved: whether it holds.
        status: "planned", or the code of the reason why there is no answer.
        detail: a sentence for people; empty when there is nothing to say.
        index: effort or index J, recomputed from the posture; None when not solved.
        residuals: what was recomputed, by name with its unit, such as "position_m".
        margin: smallest distance of a joint to its limit [rad, or m where that joint slides].
        joints: the posture at the target [rad or m].
        iterations: what the method says it spent.
    """

    solved: bool
    status: str
    detail: str = ""
    index: float | None = None
    residuals: Mapping[str, float] = field(default_factory=dict)
    margin: float | None = None
    joints: tuple[float, ...] | None = None
    iterations: int | None = None


@dataclass(frozen=True)
class Entrant:
    """A method in a contest.

    Attributes:
        name: what rows call it.
        summary: a line for people.
        solve: the number of a target to the method's own answer, warm-started where the method
            knows how. An exception is a failure of the method, not of the contest.
        solve_cold: the same without the warm start, such as from a document's own start; None
            where the method starts from nothing.
    """

    name: str
    summary: str
    solve: Callable[[int], Any]
    solve_cold: Callable[[int], Any] | None = None


@dataclass(frozen=True)
class Contest:
    """Targets, the methods that compete for them, and what documents print of both.

    Attributes:
        scenario: its name in the registry, or of the request file.
        title: a line for people.
        origin: where the targets come from; what is reconstructed says so.
        index_name: what is minimised, with its unit.
        notes: what readers have to know, a paragraph each.
        account: judges an entrant's answer: entrant's name, number of the target, answer.
        published: by target id and method.
        published_on: the machine on which a document's times were measured; empty without any.
        reference: the method that others are compared with.
        problem: the approach problem, where there is one; pictures are made from it.
        seeds: every seed that the targets depend on.
        findings: what the accounts say about the scenario's question, a sentence each, from the
            accounts by target id and entrant; None where there is no such question.
    """

    scenario: str
    title: str
    origin: str
    index_name: str
    target_ids: tuple[str, ...]
    entrants: tuple[Entrant, ...]
    account: Callable[[str, int, Any], Account]
    notes: tuple[str, ...] = ()
    published: Mapping[tuple[str, str], Published] = field(default_factory=dict)
    published_on: str = ""
    reference: str = "ncos"
    problem: Problem | None = None
    seeds: tuple[int, ...] = ()
    findings: Callable[[Mapping[tuple[str, str], Account]], tuple[str, ...]] | None = None


def with_entrants(contest: Contest, names: Sequence[str] | None) -> Contest:
    """The contest with the entrants of these names only, in its own order; as it is for None.

    Raises:
        UnknownEntrant: no entrant has one of the names.
    """
    if names is None:
        return contest
    known = tuple(entrant.name for entrant in contest.entrants)
    for name in names:
        if name not in known:
            raise UnknownEntrant(name, known=known)
    return replace(
        contest, entrants=tuple(entrant for entrant in contest.entrants if entrant.name in names)
    )
