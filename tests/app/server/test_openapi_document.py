"""The OpenAPI document tells people what every field is, and nothing in it is stale."""

import dataclasses
import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from app.schemas.faults import MOST_FAULTS
from app.schemas.options import TEXTS, known_values
from app.server.application import create_app
from app.services.plans.wire import parse_request, problem_from_wire
from app.settings import Settings
from app.store import executions, jobs
from hardware.bus.packets import ERROR_NAMES
from hardware.end_effector.end_effectors import END_EFFECTORS
from solver import InvalidProblem, Options, Problem
from solver.comparison.run import MAXIMUM_REPEATS, MOST_REPEATS
from solver.comparison.summary import FAILURE_CHARGE
from solver.frames.tolerances import (
    FURTHEST_M,
    LEAST_PAIRS,
    MOST_PAIRS,
    ORTHONORMAL,
    SHORTEST_DIRECTION,
    UNIT_QUATERNION,
)
from solver.problem.options import MOST_WEIGHT, RANGES
from solver.problem.solution import REASON_CODES
from solver.problem.tolerances import (
    LARGEST_STD_REACHES,
    LONGEST_SEGMENT_M,
    SAME_POINT_M,
    UNIT_MISTAKE_REACHES,
)

Schema = dict[str, Any]

# The longest endings first: a field that ends in _rad_s ends in _s too.
UNITS = {
    "_rad_s2": "rad/s2",
    "_m_s2": "m/s2",
    "_rad_s": "rad/s",
    "_m_s": "m/s",
    "_percent": "%",
    "_rad": "rad",
    "_gib": "GiB",
    "_kg": "kg",
    "_m": "m",
    "_s": "s",
    "_c": "°C",
    "_v": "V",
}


@pytest.fixture(scope="module")
def document() -> Schema:
    return create_app(Settings()).openapi()


@pytest.fixture(scope="module")
def schemas(document: Schema) -> Schema:
    found: Schema = document["components"]["schemas"]
    return found


def fields(schemas: Schema) -> Iterator[tuple[str, str, Schema]]:
    for owner, schema in schemas.items():
        for name, field in schema.get("properties", {}).items():
            yield f"{owner}.{name}", name, field


def parameters(document: Schema) -> Iterator[tuple[str, Schema]]:
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            for parameter in operation.get("parameters", ()):
                yield f"{method} {path} {parameter['name']}", parameter


def read(body: Schema) -> Problem:
    return problem_from_wire(parse_request(json.dumps(body).encode()))


def test_every_schema_field_and_parameter_is_described(document: Schema, schemas: Schema) -> None:
    assert len(schemas) > 50
    assert [name for name, schema in schemas.items() if not schema.get("description")] == []
    described = [*((where, field) for where, _, field in fields(schemas)), *parameters(document)]
    assert len(described) > 400
    assert [where for where, field in described if not field.get("description", "").strip()] == []


def test_descriptions_are_of_one_form(document: Schema, schemas: Schema) -> None:
    for where, _, field in fields(schemas):
        text = field["description"]
        assert text == " ".join(text.split()), where
        assert not text.endswith("."), where
        assert not re.match("[A-Z][a-z]", text), where
        assert "None" not in text, where


def test_units_of_names_are_those_of_descriptions(schemas: Schema) -> None:
    seen = set()
    for where, name, field in fields(schemas):
        ending = next((ending for ending in UNITS if name.endswith(ending)), None)
        if ending is not None:
            seen.add(ending)
            assert f"[{UNITS[ending]}]" in field["description"], where
    assert seen == set(UNITS)


def test_options_have_the_solvers_ranges_defaults_and_values(schemas: Schema) -> None:
    asked = schemas["OptionsBody"]["properties"]
    names = [entry.name for entry in dataclasses.fields(Options)]
    assert set(asked) == set(names) == set(TEXTS)
    for entry in dataclasses.fields(Options):
        field = asked[entry.name]
        if entry.name in RANGES:
            assert (field["minimum"], field["maximum"]) == RANGES[entry.name]
        else:
            assert not {"minimum", "maximum"} & set(field), entry.name
        if isinstance(entry.default, str):
            assert f"default {entry.default}" in field["description"]
            assert all(value in field["description"] for value in known_values()[entry.name])
        elif entry.default is not None:
            value = field["description"].rpartition("default ")[2]
            assert json.loads(value) == entry.default, entry.name


def test_known_values_are_what_the_solver_takes(request_body: Schema) -> None:
    """The refusal of an unknown name lists the known ones."""
    for name, known in known_values().items():
        options = {name: ["unknown"] if name == "include" else "unknown"}
        with pytest.raises(InvalidProblem) as refused:
            read(request_body | {"options": options})
        (fault,) = refused.value.faults
        assert fault.detail == f"not available; available: {', '.join(known)}"


def test_options_of_an_answer_are_told_in_the_same_words(schemas: Schema) -> None:
    answered = schemas["ResolvedOptions"]["properties"]
    assert set(answered) == set(TEXTS)
    for name, text in TEXTS.items():
        for field in (answered[name], schemas["OptionsBody"]["properties"][name]):
            assert field["description"].startswith(text)


@pytest.mark.parametrize("name", RANGES)
def test_the_solver_refuses_what_is_outside_a_range(
    name: str, schemas: Schema, request_body: Schema
) -> None:
    field = schemas["OptionsBody"]["properties"][name]
    for value in (field["minimum"] - 1, field["maximum"] + 1):
        with pytest.raises(InvalidProblem) as refused:
            read(request_body | {"options": {name: value}})
        # A standoff may be too short for the strike zone as well.
        assert f"#/options/{name}" in [fault.pointer for fault in refused.value.faults]


def test_bounds_are_the_codes(schemas: Schema) -> None:
    def field(owner: str, name: str) -> Schema:
        found: Schema = schemas[owner]["properties"][name]
        return found

    def items(owner: str, name: str) -> tuple[int | None, int | None]:
        found = field(owner, name)
        return found.get("minItems"), found.get("maxItems")

    assert items("FrameRegistrationRequest", "pairs") == (LEAST_PAIRS, MOST_PAIRS)
    assert items("FrameRequest", "check_pairs") == (1, MOST_PAIRS)
    assert items("FrameRequest", "rotation_matrix") == (3, 3)
    assert items("FrameRequest", "quaternion_xyzw") == (4, 4)
    assert items("PlanRequest", "targets") == (1, None)
    assert items("TargetBody", "position_m") == items("PointPairBody", "base_m") == (3, 3)
    assert items("BlossomBranchBody", "points_m") == (2, None)
    assert items("ThinningSelectionRequest", "branches") == (1, None)
    assert items("ComparisonRequest", "methods") == (1, None)
    for owner in ("TargetBody", "BlossomBody", "BlossomBranchBody"):
        assert field(owner, "id")["minLength"] == 1
    repeats = field("ComparisonRequest", "repeats")
    assert (repeats["minimum"], repeats["maximum"]) == (1, MAXIMUM_REPEATS)


def test_numbers_in_words_are_the_codes(schemas: Schema) -> None:
    told = {where: field["description"] for where, _, field in fields(schemas)}
    assert LARGEST_STD_REACHES == 1 / 4
    assert "a quarter of the arm's reach" in told["TargetBody.position_std_m"]
    for where, words in {
        "TargetBody.position_m": f"{UNIT_MISTAKE_REACHES:g} times the arm's reach",
        "TargetBody.branch_direction": f"above {SHORTEST_DIRECTION:g}".replace("e-09", "e-9"),
        "OptionsBody.joint_weights": f"0 to {MOST_WEIGHT:g}",
        "FrameRequest.position_m": f"at most {FURTHEST_M:g}".replace("e+0", "e"),
        "FrameRequest.quaternion_xyzw": f"within {UNIT_QUATERNION:g}",
        "FrameRequest.rotation_matrix": f"within {ORTHONORMAL:g}",
        "FrameRequest.check_pairs": f"1 to {MOST_PAIRS}",
        "FrameRegistrationRequest.pairs": f"{LEAST_PAIRS} to {MOST_PAIRS}",
        "BlossomBranchBody.points_m": f"{SAME_POINT_M:g} to {LONGEST_SEGMENT_M:g} m apart".replace(
            "e-06", "e-6"
        ),
        "ComparisonRequest.repeats": f"1 to {MAXIMUM_REPEATS}; default: as many as fit into a "
        f"minute, {MOST_REPEATS} at most",
        "MethodSummaryAnswer.charged_time_s": f"{FAILURE_CHARGE:g} times the longest time",
        "ProblemDetails.errors": f"{MOST_FAULTS} at most",
        "JobsAnswer.jobs": f"{jobs.MOST_LISTED} at most",
        "ExecutionsAnswer.executions": f"{executions.MOST_LISTED} at most",
    }.items():
        assert words in told[where], where


def test_codes_and_names_in_words_are_the_codes(schemas: Schema) -> None:
    told = {where: field["description"] for where, _, field in fields(schemas)}
    for where, names in {
        "ReasonAnswer.code": REASON_CODES,
        "ServoAnswer.errors": ERROR_NAMES,
        "RobotStateAnswer.end_effector": END_EFFECTORS,
    }.items():
        assert all(re.search(rf"\b{name}\b", told[where]) for name in names), where
