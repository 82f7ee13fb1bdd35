"""Families of arms: which is whose, and that another is a row."""

import json
from collections.abc import Iterator

import pytest

from app.routers.robots import list_robots
from solver import InvalidProblem, Options, Problem, Robot, load_robot, solve
from solver.kinematics.families import registry
from solver.kinematics.families.family import Family
from solver.kinematics.families.registry import FAMILIES, family_of, why_no_closed_form
from solver.problem.solution import PLANNED
from tests.solver.kinematics.arms import arms, seven_joints, ur5
from tests.solver.problems import DATA_SET_3

MINE = Family(
    "mine",
    "an arm of which nobody believes the closed form",
    lambda robot, _: robot.name == "tabletop",
)


@pytest.fixture
def with_mine(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A family of a few lines, in the registry."""
    monkeypatch.setattr(registry, "FAMILIES", (MINE, *FAMILIES))
    family_of.cache_clear()
    yield
    family_of.cache_clear()


@pytest.mark.parametrize(
    ("robots", "name"),
    [
        (arms(), "spherical_wrist"),
        ([load_robot("puma560_rail")], "spherical_wrist_on_rail"),
        ([ur5(), seven_joints()], "general"),
    ],
)
def test_every_arm_has_one(robots: list[Robot], name: str) -> None:
    for robot in robots:
        family = family_of(robot, robot.tools[0])
        assert family.name == name
        assert (why_no_closed_form(robot, robot.tools[0]) is None) == family.has_closed_form


def test_names_are_used_once() -> None:
    assert len({family.name for family in FAMILIES}) == len(FAMILIES)
    assert all(family.summary for family in FAMILIES)


@pytest.mark.usefixtures("with_mine")
def test_another_family_plans(tabletop: Robot) -> None:
    plan = solve(Problem(tabletop, DATA_SET_3, Options(order="independent")))
    assert plan.planned >= 4
    done = [one for one in plan.approaches if one.status == PLANNED]
    assert all(one.branch is None for one in done)
    assert plan.problem.options.position_margin_m == 0.0
    refused = solve(Problem(tabletop, DATA_SET_3, Options(method="ssas")))
    assert {one.reason.code for one in refused.approaches if one.reason} == {
        "method_not_applicable"
    }


@pytest.mark.usefixtures("with_mine")
@pytest.mark.parametrize(
    "options",
    [
        Options(strike_zone_m=0.01),
        Options(position_margin_m=0.001),
        Options(certify=True),
        Options(order="optimal"),
        Options(include=("arcs",)),
    ],
)
def test_it_is_refused_what_it_cannot(tabletop: Robot, options: Options) -> None:
    with pytest.raises(InvalidProblem) as caught:
        Problem(tabletop, DATA_SET_3, options)
    assert all("closed form" in fault.detail for fault in caught.value.faults)
    assert MINE.summary in caught.value.faults[0].detail


@pytest.mark.usefixtures("with_mine")
def test_it_is_told_of_the_robot() -> None:
    robots = json.loads(bytes(list_robots().body))["robots"]
    told = {robot["name"]: robot["kinematics"] for robot in robots}
    assert told["tabletop"] == "mine"
    assert told["puma560_rail"] == "spherical_wrist_on_rail"
