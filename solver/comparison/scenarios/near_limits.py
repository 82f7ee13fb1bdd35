"""`near-limits`: targets with little room, where methods and tolerances are told apart."""

import math
from collections.abc import Sequence
from typing import Final

from solver.approach.arcs.of_problem import feasible_arcs
from solver.comparison.approach_contest import approach_contest, chosen, method_variants
from solver.comparison.contest import Contest
from solver.comparison.targets import as_targets, drawn_at_edges
from solver.problem.options import Options
from solver.problem.problem import Problem
from solver.problem.solution import Arc
from solver.robots.files import load_robot

SEED: Final = 20_122
TARGETS: Final = 50
DRAWN: Final = 600
"""Enough to find them: one in nine has narrow arcs only."""
NARROW_RAD: Final = 2 * math.pi / 50
"""No feasible arc of these targets is wider than this, the step of floating_z with T's 50 angles,
which therefore may fall beside every arc [rad]."""


def near_limits_problem(seed: int = SEED, count: int = TARGETS) -> Problem:
    """The first targets drawn at the edges that have feasible arcs, and narrow ones only.

    Raises:
        ValueError: too few of those drawn are such.
    """
    robot, options = load_robot("tabletop"), Options()
    tool = robot.tool(robot.default_tool)
    assert tool is not None, "parse_robot checks it"
    drawn = max(DRAWN, 12 * count)
    positions, directions = drawn_at_edges(robot, tool, options.limit_margin_rad, seed, drawn)
    found = feasible_arcs(Problem(robot, as_targets(positions, directions, range(drawn))))
    narrow = [k for k in range(drawn) if _only_narrow(found[str(k)])]
    if len(narrow) < count:
        raise ValueError(f"seed {seed}: {len(narrow)} targets have narrow arcs, wanted {count}")
    return Problem(robot, as_targets(positions, directions, narrow[:count]))


def _only_narrow(arcs: Sequence[Arc]) -> bool:
    widths = [arc.upper_rad - arc.lower_rad for arc in arcs]
    return bool(widths) and max(widths) <= NARROW_RAD


def near_limits_contest(methods: Sequence[str] | None) -> Contest:
    """The contest; None: all methods.

    Raises:
        UnknownEntrant: there is no such method.
    """
    problem = near_limits_problem()
    return approach_contest(
        problem,
        chosen(method_variants(problem), methods),
        scenario="near-limits",
        title=f"{TARGETS} targets with little room, at the edges of what the arm can do",
        origin="Where random postures put the tool: a third with a joint beside its limit, a third "
        "with a nearly straight wrist, a third with a nearly stretched arm; branches along the "
        "tool's y axis. Kept are those that have an approach, but no feasible arc wider than 7.2 "
        "degrees.",
        notes=(
            "floating_z tries angles 7.2 degrees apart and may fall beside every arc; that is a "
            "failure of the method, as every one of these targets has an approach.",
        ),
        seeds=(SEED,),
    )
