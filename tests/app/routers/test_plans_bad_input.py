import copy
import json
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from tests.app.conftest import Server, assert_problem

MARKER = "qq7z"
Body = dict[str, Any]
BIG = 10**6

# Each: what to set where (a path into the request), and the pointer that the answer must have.
FAULTS: dict[str, tuple[tuple[str | int, ...], Any, str]] = {
    "zero direction": (
        ("targets", 0, "branch_direction"), [0, 0, 0], "#/targets/0/branch_direction"),
    "short position": (("targets", 0, "position_m"), [0.1, 0.2], "#/targets/0/position_m"),
    "long position": (("targets", 1, "position_m"), [0.1] * 4, "#/targets/1/position_m"),
    "short direction": (
        ("targets", 0, "branch_direction"), [1.0], "#/targets/0/branch_direction"),
    "no position": (("targets", 0, "position_m"), [], "#/targets/0/position_m"),
    "centimetres": (("targets", 0, "position_m"), [18.5, -5.7, 42.0], "#/targets/0/position_m"),
    "far away": (("targets", 0, "position_m"), [1e308, 1e308, 0], "#/targets/0/position_m"),
    "unknown robot": (("robot",), MARKER, "#/robot"),
    "robot path": (("robot",), f"../{MARKER}", "#/robot"),
    "unknown tool": (("tool",), MARKER, "#/tool"),
    "unknown method": (("options", "method"), MARKER, "#/options/method"),
    "unknown order": (("options", "order"), MARKER, "#/options/order"),
    "unknown norm": (("options", "norm"), MARKER, "#/options/norm"),
    "unknown weights": (("options", "weights"), MARKER, "#/options/weights"),
    "unknown include": (("options", "include"), [MARKER], "#/options/include/0"),
    "unknown option": (("options", "stand_off"), MARKER, "#/options/stand_off"),
    "unknown field": (("robots",), MARKER, "#/robots"),
    "unknown target field": (("targets", 0, "colour"), MARKER, "#/targets/0/colour"),
    "field to escape": (("a/b~c",), MARKER, "#/a~1b~0c"),
    "long field": (("options", MARKER * 1000), 1, "#/options"),
    "empty id": (("targets", 0, "id"), "", "#/targets/0/id"),
    "number as id": (("targets", 0, "id"), 1, "#/targets/0/id"),
    "empty batch": (("targets",), [], "#/targets"),
    "no list": (("targets",), {"id": MARKER}, "#/targets"),
    "start outside": (
        ("start_joints",), [9.0, 1.57, -1.5757, 0, 1.5757, 0], "#/start_joints/0"),
    "start short": (("start_joints",), [0.0], "#/start_joints"),
    "start null": (("start_joints",), None, "#/start_joints"),
    "tool null": (("tool",), None, "#/tool"),
    "options null": (("options",), None, "#/options"),
    "text as number": (
        ("targets", 0, "position_m"), [MARKER, 0, 0], "#/targets/0/position_m/0"),
    "digits as number": (
        ("targets", 0, "position_m"), ["0.1", 0, 0], "#/targets/0/position_m/0"),
    "bool as number": (("targets", 0, "position_m"), [True, 0, 0], "#/targets/0/position_m/0"),
    "number as bool": (("options", "symmetric_tool"), 1, "#/options/symmetric_tool"),
    "float as int": (("options", "samples"), 1.5, "#/options/samples"),
    "samples zero": (("options", "samples"), 0, "#/options/samples"),
    "samples huge": (("options", "samples"), 10**30, "#/options/samples"),
    "standoff zero": (("options", "standoff_m"), 0, "#/options/standoff_m"),
    "path points": (("options", "path_points"), BIG, "#/options/path_points"),
    "dwell negative": (("options", "dwell_s"), -1, "#/options/dwell_s"),
    "strike zone": (("options", "strike_zone_m"), 0.6, "#/options/strike_zone_m"),
    "number as certify": (("options", "certify"), 1, "#/options/certify"),
    "joint weights short": (("options", "joint_weights"), [1.0], "#/options/joint_weights"),
    "joint weights negative": (
        ("options", "joint_weights"), [-1, 1, 1, 1, 1, 1], "#/options/joint_weights"),
    "arcs and nonsense": (("options", "include"), ["arcs", MARKER], "#/options/include/1"),
    "frame": (("frame",), MARKER, "#/frame"),
    "scene": (("scene",), {}, "#/scene"),
    "scene with branches": (
        ("scene",),
        {"branches": [{"id": MARKER, "points_m": [[0, 0, 0]], "radius_m": 0.1}]}, "#/scene"),
    "deviation negative": (
        ("targets", 1, "position_std_m"), -0.002, "#/targets/1/position_std_m"),
    "deviation in millimetres": (
        ("targets", 1, "position_std_m"), 2.0, "#/targets/1/position_std_m"),
}  # fmt: skip

NOT_FINITE = ["NaN", "Infinity", "-Infinity", "1e999", "-1e999", "1" + "0" * 400]
NOT_JSON = {
    "nothing": b"",
    "text": MARKER.encode(),
    "cut off": b'{"robot": "qq7z',
    "invalid UTF-8": b'{"robot": "qq7z\xff\xfe"}',
    "lone surrogate": b'{"robot": "qq7z\\ud800"}',
    "deep": b"[" * 100_000,
    "deep field": b'{"robot":' * 5_000,
    "UTF-16": '{"robot": "qq7z"}'.encode("utf-16"),
    "list": b'["qq7z"]',
    "null": b"null",
    "NaN": b"NaN",
}


@pytest.fixture(autouse=True)
def _nothing_is_stored(server: Server) -> Iterator[None]:
    before = server.stored_plans()
    yield
    assert server.stored_plans() == before


def post(server: Server, content: bytes, media_type: str = "application/json") -> httpx2.Response:
    return server.client.post("/v1/plans", content=content, headers={"Content-Type": media_type})


def changed(body: Body, path: tuple[str | int, ...], value: Any) -> Body:
    body = copy.deepcopy(body)
    place: Any = body
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return body


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_pointed_to(name: str, server: Server, request_body: Body) -> None:
    path, value, pointer = FAULTS[name]
    answer = server.client.post("/v1/plans", json=changed(request_body, path, value))
    problem = assert_problem(answer, 422, pointer)
    assert MARKER not in answer.text
    assert all(error["detail"] for error in problem["errors"])


@pytest.mark.parametrize("number", NOT_FINITE)
@pytest.mark.parametrize(
    ("path", "pointer"),
    [
        (("targets", 0, "position_m", 1), "#/targets/0/position_m/1"),
        (("targets", 4, "branch_direction", 0), "#/targets/4/branch_direction/0"),
        (("start_joints", 2), "#/start_joints/2"),
        (("options", "standoff_m"), "#/options/standoff_m"),
    ],
)
def test_number_that_is_not_finite(
    number: str, path: tuple[str | int, ...], pointer: str, server: Server, request_body: Body
) -> None:
    if path[0] == "options":
        request_body["options"]["standoff_m"] = 0.04
    text = json.dumps(changed(request_body, path, MARKER)).replace(f'"{MARKER}"', number)
    answer = post(server, text.encode())
    assert_problem(answer, 422, pointer)
    assert number not in answer.text or number == "Infinity"


@pytest.mark.parametrize("name", NOT_JSON)
def test_not_json(name: str, server: Server) -> None:
    answer = post(server, NOT_JSON[name])
    assert_problem(answer, 422, "#")
    assert MARKER not in answer.text


def test_duplicate_ids(server: Server, request_body: Body) -> None:
    for target in request_body["targets"][1:3]:
        target["id"] = MARKER
    answer = server.client.post("/v1/plans", json=request_body)
    assert_problem(answer, 422, "#/targets/2/id")
    assert MARKER not in answer.text


TWICE = {
    "#/robot": ('"robot":', '"robot": "tabletop", "robot":'),
    "#/targets/0/position_m": ('"position_m":', '"position_m": [0.1, 0.1, 0.1], "position_m":'),
    "#/options/method": ('"method":', '"method": "ncos", "method":'),
    # The one inside is in an object that does not count.
    "#/options": ('"options":', '"options": {"norm": "l1", "norm": "l2"}, "options":'),
}


@pytest.mark.parametrize("pointer", TWICE)
def test_a_name_that_stands_twice(pointer: str, server: Server, request_body: Body) -> None:
    text = json.dumps(request_body).replace(*TWICE[pointer], 1)
    assert text.count('"') > json.dumps(request_body).count('"')
    (error,) = assert_problem(post(server, text.encode()), 422, pointer)["errors"]
    assert "twice" in error["detail"]


def test_what_does_not_count_may_have_any_names(server: Server, request_body: Body) -> None:
    """No schema bounds how many: comparing each with each would take minutes."""
    many = ",".join(f'"{k}":0' for k in range(80_000))
    lost = f'"options": {{{many},"0":0}}, "options":'
    text = json.dumps(request_body).replace('"options":', lost, 1)
    (error,) = assert_problem(post(server, text.encode()), 422, "#/options")["errors"]
    assert "twice" in error["detail"]


@pytest.mark.parametrize(
    ("path", "body", "name"),
    [
        ("/v1/executions", '{"plan_id": "1", "plan_id": "2", "robot": "tabletop"}', "plan_id"),
        ("/v1/comparisons", '{"scenario": "data-set-3", "scenario": "strawberry"}', "scenario"),
        ("/v1/robots/tabletop/lease", '{"holder": "a", "holder": "b"}', "holder"),
        ("/v1/thinning-selections", '{"branches": [], "branches": []}', "branches"),
        ("/v1/frames/twice/registration", '{"pairs": [], "pairs": []}', "pairs"),
    ],
)
def test_a_name_that_stands_twice_elsewhere(
    path: str, body: str, name: str, server: Server
) -> None:
    headers = {"Content-Type": "application/json"}
    answer = server.client.post(path, content=body.encode(), headers=headers)
    assert_problem(answer, 422, f"#/{name}")


@pytest.mark.parametrize("field", ["robot", "targets"])
def test_missing_field(field: str, server: Server, request_body: Body) -> None:
    del request_body[field]
    assert_problem(server.client.post("/v1/plans", json=request_body), 422, f"#/{field}")


def test_all_faults_at_once(server: Server, request_body: Body) -> None:
    request_body["tool"] = MARKER
    request_body["frame"] = MARKER
    request_body["options"]["norm"] = MARKER
    problem = assert_problem(server.client.post("/v1/plans", json=request_body), 422)
    pointers = {error["pointer"] for error in problem["errors"]}
    assert pointers == {"#/tool", "#/frame", "#/options/norm"}


def test_the_strawberry_mechanism_has_no_approach_and_says_what_it_has(
    server: Server, request_body: Body
) -> None:
    answer = server.client.post("/v1/plans", json={**request_body, "robot": "strawberry"})
    (error,) = assert_problem(answer, 422, "#/robot")["errors"]
    assert "no approach" in error["detail"]
    assert "prunus compare strawberry" in error["detail"]


def test_what_needs_a_closed_form_is_refused_on_a_rail(server: Server) -> None:
    target = {"id": "1", "position_m": [0.5, 0.1, 0.4], "branch_direction": [0, 1, 0]}
    body: Body = {"robot": "puma560_rail", "targets": [target]}
    body["options"] = {"include": ["path", "arcs"], "certify": True}
    problem = assert_problem(server.client.post("/v1/plans", json=body), 422)
    pointers = {error["pointer"] for error in problem["errors"]}
    assert pointers == {"#/options/include/1", "#/options/certify"}


def test_number_of_errors_is_bounded(server: Server, request_body: Body) -> None:
    request_body["options"] = {f"{MARKER}{k}": k for k in range(5_000)}
    problem = assert_problem(server.client.post("/v1/plans", json=request_body), 422, "#")
    assert len(problem["errors"]) == 1


def test_many_spoiled_targets_cost_little(server: Server, request_body: Body) -> None:
    request_body["targets"] = [{}] * 40_000
    problem = assert_problem(server.client.post("/v1/plans", json=request_body), 422)
    assert {error["pointer"] for error in problem["errors"]} == {
        "#/targets/0/id", "#/targets/0/position_m", "#/targets/0/branch_direction",
    }  # fmt: skip


def test_batch_over_the_limit_of_an_answer_at_once(server: Server) -> None:
    targets = [
        {"id": f"{k}", "position_m": [9, 0, 0], "branch_direction": [0, 0, 1]} for k in range(2001)
    ]
    body = {"robot": "tabletop", "targets": targets, "options": {"method": "fixed_z"}}
    answer = server.client.post("/v1/plans", json=body)
    assert answer.status_code == 202, answer.text
    canceled = server.client.delete(answer.headers["location"])
    assert canceled.status_code in (202, 409)


def test_service_survived_it_all(server: Server) -> None:
    assert server.client.get("/readyz").status_code == 200
