import copy
import json
from typing import Any

import pytest

from tests.app.conftest import BODY_LIMIT_BYTES, Server, assert_problem

PATH = "/v1/thinning-selections"
MARKER = "qq7z"
Body = dict[str, Any]

# T 4.2.1, data set 1: a horizontal branch along y with ten blossoms, of which seven are removed.
DATA_SET_1: Body = {
    "branches": [
        {
            "id": "b1",
            "points_m": [[0.23, -0.035, 0.315], [0.23, 0.195, 0.315]],
            "blossoms": [
                {"id": f"x{k}", "distance_m": round(0.085 + 0.015 * k, 3)} for k in range(10)
            ],
        }
    ]
}


@pytest.fixture
def body() -> Body:
    return copy.deepcopy(DATA_SET_1)


def test_selection_is_what_the_contract_says(server: Server, body: Body) -> None:
    answer = server.client.post(PATH, json=body)
    assert answer.status_code == 200
    found = answer.json()
    assert set(found) == {"targets", "keepers"}
    assert [one["id"] for one in found["keepers"]] == ["x0", "x7", "x9"]
    assert [one["id"] for one in found["targets"]] == ["x1", "x2", "x3", "x4", "x5", "x6", "x8"]
    seventh = found["targets"][-1]
    assert set(seventh) == {"id", "branch_id", "position_m", "branch_direction", "distance_m"}
    assert seventh["position_m"] == pytest.approx([0.23, 0.17, 0.315])  # as T prints it
    assert seventh["branch_direction"] == [0.0, 1.0, 0.0]
    assert (seventh["branch_id"], seventh["distance_m"]) == ("b1", 0.205)


def test_targets_can_be_planned(server: Server, body: Body) -> None:
    """The whole way as docs/task_definition.md has it: three fields of each target go on."""
    selection = server.client.post(PATH, json=body).json()
    fields = ("id", "position_m", "branch_direction")
    targets = [{name: target[name] for name in fields} for target in selection["targets"]]
    plan: Body = {"robot": "tabletop", "tool": "scaffold", "targets": targets}
    plan["options"] = {"method": "ssas", "order": "independent", "include": ["path"]}
    answer = server.client.post("/v1/plans", json=plan)
    assert answer.status_code == 201, answer.text
    approaches = answer.json()["approaches"]
    assert [one["target_id"] for one in approaches] == [one["id"] for one in targets]
    assert {one["status"] for one in approaches} == {"planned"}


def test_nothing_to_select_is_an_answer(server: Server, body: Body) -> None:
    body["branches"][0]["blossoms"] = []
    assert server.client.post(PATH, json=body).json() == {"targets": [], "keepers": []}


BRANCH = ("branches", 0)
FAULTS: dict[str, tuple[tuple[str | int, ...], Any, str]] = {
    "no branches": (("branches",), [], "#/branches"),
    "no list": (("branches",), {"id": MARKER}, "#/branches"),
    "null": (("branches",), None, "#/branches"),
    "unknown field": ((MARKER,), MARKER, f"#/{MARKER}"),
    "unknown branch field": ((*BRANCH, "colour"), MARKER, "#/branches/0/colour"),
    "one point": ((*BRANCH, "points_m"), [[0, 0, 0]], "#/branches/0/points_m"),
    "two coordinates": ((*BRANCH, "points_m", 1), [0, 0], "#/branches/0/points_m/1"),
    "no length": ((*BRANCH, "points_m", 1), [0.23, -0.035, 0.315], "#/branches/0/points_m/1"),
    "far away": ((*BRANCH, "points_m", 1), [1e308, 0, 0], "#/branches/0/points_m/1"),
    "text as coordinate": (
        (*BRANCH, "points_m", 1, 2), MARKER, "#/branches/0/points_m/1/2"),
    "empty branch id": ((*BRANCH, "id"), "", "#/branches/0/id"),
    "number as id": ((*BRANCH, "id"), 1, "#/branches/0/id"),
    "beyond the tip": (
        (*BRANCH, "blossoms", 2, "distance_m"), 0.2300001, "#/branches/0/blossoms/2/distance_m"),
    "centimetres": (
        (*BRANCH, "blossoms", 2, "distance_m"), 10, "#/branches/0/blossoms/2/distance_m"),
    "before the origin": (
        (*BRANCH, "blossoms", 2, "distance_m"), -0.001, "#/branches/0/blossoms/2/distance_m"),
    "digits as distance": (
        (*BRANCH, "blossoms", 2, "distance_m"), "0.1", "#/branches/0/blossoms/2/distance_m"),
    "empty blossom id": ((*BRANCH, "blossoms", 3, "id"), "", "#/branches/0/blossoms/3/id"),
    "blossom id twice": ((*BRANCH, "blossoms", 3, "id"), "x1", "#/branches/0/blossoms/3/id"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_nonsense_is_pointed_to(name: str, server: Server, body: Body) -> None:
    path, value, pointer = FAULTS[name]
    place: Any = body
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    answer = server.client.post(PATH, json=body)
    problem = assert_problem(answer, 422, pointer)
    assert all(error["detail"] for error in problem["errors"])
    if pointer != f"#/{MARKER}":
        assert MARKER not in answer.text


@pytest.mark.parametrize("field", ["id", "points_m", "blossoms"])
def test_missing_field(field: str, server: Server, body: Body) -> None:
    del body["branches"][0][field]
    assert_problem(server.client.post(PATH, json=body), 422, f"#/branches/0/{field}")


def test_branch_id_twice(server: Server, body: Body) -> None:
    body["branches"] *= 2
    body["branches"][0]["id"] = body["branches"][1]["id"] = MARKER
    answer = server.client.post(PATH, json=body)
    assert_problem(answer, 422, "#/branches/1/id")
    assert MARKER not in answer.text


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", "1" + "0" * 400])
def test_number_that_is_not_finite(number: str, server: Server, body: Body) -> None:
    body["branches"][0]["blossoms"][0]["distance_m"] = MARKER
    text = json.dumps(body).replace(f'"{MARKER}"', number)
    headers = {"Content-Type": "application/json"}
    answer = server.client.post(PATH, content=text.encode(), headers=headers)
    assert_problem(answer, 422, "#/branches/0/blossoms/0/distance_m")
    assert number not in answer.text or number == "Infinity"


def test_size_limits(server: Server, body: Body) -> None:
    headers = {"Content-Type": "application/json"}
    assert_problem(
        server.client.post(PATH, content=b" " * (BODY_LIMIT_BYTES + 1), headers=headers), 413
    )
    text = {"Content-Type": "text/plain"}
    assert_problem(server.client.post(PATH, content=b"{}", headers=text), 415)
    body["branches"][0]["blossoms"] = [{"id": "", "distance_m": -1}] * 5_000
    problem = assert_problem(server.client.post(PATH, json=body), 422)
    assert len(problem["errors"]) == 100
