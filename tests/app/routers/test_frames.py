"""Frames over HTTP, and plans of targets in them."""

import contextlib
import json
import sqlite3
from collections.abc import Iterator
from typing import Any

import httpx2
import numpy as np
import pytest

from app.services.plans.wire import parse_request, problem_from_wire
from app.services.robots.motions import target_motions
from hardware.link.messages import TargetMotion, decode_from_service
from solver import InvalidProblem
from solver.frames.transforms import RigidTransform, transform_from_matrix
from tests.app.conftest import EXAMPLE, Server, assert_problem
from tests.app.routers.test_plans import comparable, has_null, run

Body = dict[str, Any]
MARKER = "qq7z"
PATH = "/v1/frames/camera"

# A camera behind the arm that looks along the base's x axis: its z forward, its x to the right.
POSITION = [-0.25, 0.02, 0.45]
QUATERNION = [-0.5, 0.5, -0.5, 0.5]
MATRIX = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
POSE: Body = {"position_m": POSITION, "quaternion_xyzw": QUATERNION}
CAMERA: RigidTransform = transform_from_matrix(POSITION, MATRIX)[0]


@pytest.fixture(autouse=True)
def _no_frame_is_left(server: Server) -> Iterator[None]:
    yield
    for frame in server.client.get("/v1/frames").json()["frames"]:
        assert server.client.delete(f"/v1/frames/{frame['name']}").status_code == 204


def put(server: Server, body: Body, status: int = 201) -> Body:
    answer = server.client.put(PATH, json=body)
    assert answer.status_code == status, answer.text
    frame: Body = answer.json()
    assert not has_null(frame)
    return frame


def pairs(count: int = 5, noise_m: float = 0.0) -> list[Body]:
    rng = np.random.default_rng(count)
    # Where the tip of the arm can be: it touches them.
    frame = rng.uniform(-0.1, 0.1, (count, 3)) + np.array([0, 0.1, 0.5])
    base = CAMERA.points(frame) + rng.normal(size=frame.shape) * noise_m
    return [
        {"frame_m": seen, "base_m": touched}
        for seen, touched in zip(frame.tolist(), base.tolist(), strict=True)
    ]


def in_camera(body: Body) -> Body:
    """The request with its targets as the camera sees them."""
    back = CAMERA.inverse
    targets = [
        {
            **target,
            "position_m": back.points(np.array([target["position_m"]]))[0].tolist(),
            "branch_direction": back.directions(np.array([target["branch_direction"]]))[0].tolist(),
        }
        for target in body["targets"]
    ]
    return {**body, "frame": "camera", "targets": targets}


def test_a_frame_is_put_read_replaced_and_deleted(server: Server) -> None:
    answer = server.client.put(PATH, json=POSE)
    assert answer.status_code == 201
    assert answer.headers["location"] == PATH
    frame = answer.json()
    assert set(frame) == {
        "name", "source", "position_m", "quaternion_xyzw", "rotation_matrix", "warnings",
        "created_at", "updated_at",
    }  # fmt: skip
    assert (frame["name"], frame["source"], frame["warnings"]) == ("camera", "given", [])
    assert (frame["position_m"], frame["quaternion_xyzw"]) == (POSITION, QUATERNION)
    assert frame["rotation_matrix"] == MATRIX
    assert server.client.get(PATH).json() == frame
    listed = server.client.get("/v1/frames").json()["frames"]
    assert [entry for entry in listed if entry["name"] == "camera"] == [frame]

    replaced = put(server, {"position_m": [0, 0, 0], "rotation_matrix": MATRIX}, 200)
    assert replaced["quaternion_xyzw"] == pytest.approx(QUATERNION)
    assert replaced["created_at"] == frame["created_at"] == frame["updated_at"]
    assert replaced["updated_at"] >= frame["updated_at"]
    again = put(server, {"position_m": [0, 0, 0], "rotation_matrix": MATRIX}, 200)
    assert {**again, "updated_at": ""} == {**replaced, "updated_at": ""}

    removed = server.client.delete(PATH)
    assert (removed.status_code, removed.content) == (204, b"")
    assert_problem(server.client.get(PATH), 404)
    assert_problem(server.client.delete(PATH), 404)


def test_check_pairs_tell_of_an_inverted_pose(server: Server) -> None:
    checked = put(server, {**POSE, "check_pairs": pairs(noise_m=0.001)})
    assert checked["warnings"] == []
    assert len(checked["residuals_m"]) == 5
    assert 0 < checked["rms_residual_m"] <= checked["max_residual_m"] < 0.005
    assert checked["max_residual_m"] == max(checked["residuals_m"])
    assert checked["scale"] == pytest.approx(1, abs=0.02)
    assert "rotation_std_rad" not in checked

    back = CAMERA.inverse
    inverted: Body = {
        "position_m": list(back.position_m),
        "quaternion_xyzw": list(back.quaternion_xyzw),
    }
    for count in (1, 5):
        told = put(server, {**inverted, "check_pairs": pairs(5)[:count]}, 200)
        assert [row["code"] for row in told["warnings"]] == ["inverted"]
        assert "base_from_frame" in told["warnings"][0]["detail"]
        assert ("scale" in told) == (count >= 3)
    # The list leaves the residuals of single pairs out.
    (listed,) = server.client.get("/v1/frames").json()["frames"]
    assert listed == {name: value for name, value in told.items() if name != "residuals_m"}


def test_a_frame_is_estimated_from_points(server: Server) -> None:
    given = {"pairs": pairs(6, noise_m=0.0005), "robot": "tabletop"}
    answer = server.client.post(f"{PATH}/registration", json=given)
    assert answer.status_code == 201, answer.text
    assert answer.headers["location"] == PATH
    frame = answer.json()
    assert not has_null(frame)
    assert frame["source"] == "estimated"
    assert frame["position_m"] == pytest.approx(POSITION, abs=0.005)
    assert frame["rotation_matrix"] == [pytest.approx(row, abs=0.01) for row in MATRIX]
    assert len(frame["residuals_m"]) == 6
    assert frame["rms_residual_m"] < 0.002
    assert 0 < frame["rotation_std_rad"] < 0.01
    assert frame["warnings"] == []
    assert server.client.get(PATH).json() == frame
    given["pairs"] = pairs(3)
    again = server.client.post(f"{PATH}/registration", json=given)
    assert again.status_code == 201
    assert [row["code"] for row in again.json()["warnings"]] == ["few_pairs"]
    assert again.json()["created_at"] == frame["created_at"]


def test_what_points_show_is_warned_of(server: Server) -> None:
    def codes(given: list[Body], **more: str) -> list[str]:
        body = {"pairs": given, **more}
        answer = server.client.post(f"{PATH}/registration", json=body)
        assert answer.status_code == 201, answer.text
        return [row["code"] for row in answer.json()["warnings"]]

    millimetres = [
        {**pair, "frame_m": [1000 * value for value in pair["frame_m"]]} for pair in pairs()
    ]
    assert codes(millimetres) == ["scaled"]
    # A camera 3 m away: what it sees is in its own frame out of the arm's reach.
    far = [{**pair, "frame_m": [*pair["frame_m"][:2], pair["frame_m"][2] + 3]} for pair in pairs()]
    exchanged = [{"frame_m": pair["base_m"], "base_m": pair["frame_m"]} for pair in far]
    assert codes(far, robot="tabletop") == []
    assert codes(exchanged, robot="tabletop") == ["inverted"]
    assert codes(exchanged) == ["inverted"]


def wrong(field: str, value: Any) -> Body:
    return {**POSE, field: value}


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"position_m": POSITION}, "#"),
        (wrong("rotation_matrix", MATRIX), "#/rotation_matrix"),
        ({"quaternion_xyzw": QUATERNION}, "#/position_m"),
        (wrong("position_m", [0, 0]), "#/position_m"),
        (wrong("position_m", [0, 0, 1e300]), "#/position_m"),
        (wrong("quaternion_xyzw", [1, 1, 1, 1]), "#/quaternion_xyzw"),
        (wrong("quaternion_xyzw", [0, 0, 1]), "#/quaternion_xyzw"),
        (wrong("quaternion_xyzw", None), "#/quaternion_xyzw"),
        (wrong("quaternion_xyzw", [MARKER, 0, 0, 1]), "#/quaternion_xyzw/0"),
        (wrong(MARKER, 1), f"#/{MARKER}"),
        (wrong("check_pairs", []), "#/check_pairs"),
        (wrong("check_pairs", [{"frame_m": [0, 0], "base_m": [0, 0, 0]}]),
         "#/check_pairs/0/frame_m"),
        ({"position_m": POSITION, "rotation_matrix": [[0, 0, 1], [1, 0, 0], [0, -1, 0]]},
         "#/rotation_matrix"),
        ({"position_m": POSITION, "rotation_matrix": [[0, 0, 2], [-2, 0, 0], [0, -2, 0]]},
         "#/rotation_matrix"),
        ({"position_m": POSITION, "rotation_matrix": [[0, 0, 1], [-1, 0, 0]]}, "#/rotation_matrix"),
        ({"position_m": POSITION, "rotation_matrix": [[0, 0], [-1, 0, 0], [0, -1, 0]]},
         "#/rotation_matrix/0"),
        ([], "#"),
    ],
)  # fmt: skip
def test_poses_that_make_no_sense_are_refused(server: Server, body: Any, pointer: str) -> None:
    assert_problem(server.client.put(PATH, json=body), 422, pointer)
    assert server.client.get("/v1/frames").json() == {"frames": []}


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "#/pairs"),
        ({"pairs": pairs()[:2]}, "#/pairs"),
        ({"pairs": [{"frame_m": [0.1 * k, 0, 0], "base_m": [0, 0.1 * k, 0]} for k in range(5)]},
         "#/pairs"),
        ({"pairs": [{**pair, "base_m": [-pair["base_m"][0], *pair["base_m"][1:]]}
                    for pair in pairs()]}, "#/pairs"),
        ({"pairs": [*pairs(), {"frame_m": [0, 0, 0]}]}, "#/pairs/5/base_m"),
        ({"pairs": [*pairs(), {"frame_m": [0, 0, 0], "base_m": [0, 0, 1e9]}]}, "#/pairs/5/base_m"),
        ({"pairs": pairs(), "robot": MARKER}, "#/robot"),
    ],
)  # fmt: skip
def test_points_that_make_no_sense_are_refused(server: Server, body: Body, pointer: str) -> None:
    answer = server.client.post(f"{PATH}/registration", json=body)
    assert_problem(answer, 422, pointer)
    assert MARKER not in answer.text
    assert server.client.get("/v1/frames").json() == {"frames": []}


@pytest.mark.parametrize("content", [b"", b"{", b'{"position_m": NaN}', b"\xff", b"[" * 50_000])
def test_bodies_that_are_no_json_are_refused(server: Server, content: bytes) -> None:
    headers = {"Content-Type": "application/json"}
    for answer in (
        server.client.put(PATH, content=content, headers=headers),
        server.client.post(f"{PATH}/registration", content=content, headers=headers),
    ):
        assert_problem(answer, 422)
    assert_problem(server.client.put(PATH, content=b"{}", headers={"Content-Type": "text/x"}), 415)


@pytest.mark.parametrize("name", ["base", "a b", ".hidden", "x" * 101, "%00", "caf%C3%A9", "a%3Fb"])
def test_names_that_are_none_are_refused(server: Server, name: str) -> None:
    path = f"/v1/frames/{name}"
    for answer in (
        server.client.put(path, json=POSE),
        server.client.post(f"{path}/registration", json={"pairs": pairs()}),
    ):
        problem = assert_problem(answer, 422)
        assert problem["type"].endswith(":invalid_frame_name")
    assert_problem(server.client.get(path), 404)
    assert_problem(server.client.delete(path), 404)
    assert server.client.get("/v1/frames").json() == {"frames": []}


def test_a_wrong_method_is_told_all_that_are_right(server: Server) -> None:
    answer = server.client.post(PATH, json=POSE)
    problem = assert_problem(answer, 405)
    assert problem["type"].endswith(":method_not_allowed")
    assert answer.headers["allow"] == "DELETE, GET, PUT"
    assert server.client.delete("/v1/frames").headers["allow"] == "GET"


@pytest.mark.parametrize("name", ["x" * 100, "Cam-2_left.v1", "-", "0"])
def test_names_that_are_taken(server: Server, name: str) -> None:
    answer = server.client.put(f"/v1/frames/{name}", json=POSE)
    assert answer.status_code == 201
    assert server.client.get(answer.headers["location"]).json()["name"] == name


def plan(server: Server, body: Body) -> Body:
    answer = server.client.post("/v1/plans", json=body)
    assert answer.status_code == 201, answer.text
    found: Body = answer.json()
    return found


def test_a_plan_in_a_frame_is_that_in_base(server: Server, request_body: Body) -> None:
    put(server, POSE)
    expected = plan(server, request_body)
    found = plan(server, in_camera(request_body))
    assert found.pop("frame") == "camera"
    assert found.pop("frame_transform") == POSE
    assert set(found) == set(expected)
    assert not {"frame", "frame_transform"} & set(expected)
    assert found["summary"]["planned"] == 5
    effort = expected["summary"]["total_effort"]
    assert found["summary"]["total_effort"] == pytest.approx(effort, abs=1e-6)
    for one, other in zip(found["approaches"], expected["approaches"], strict=True):
        assert one["thinning_joints"] == pytest.approx(other["thinning_joints"], abs=1e-5)
    request_body["frame"] = "base"
    assert comparable(plan(server, request_body)) == comparable(expected)


def stored(server: Server, plan_id: str) -> tuple[str, str]:
    with contextlib.closing(sqlite3.connect(server.data_dir / "prunus.sqlite3")) as database:
        query = "SELECT request, answer FROM plans WHERE id = ?"
        row: tuple[str, str] = database.execute(query, (plan_id,)).fetchone()
        return row


def test_a_frame_registered_anew_does_not_change_what_is_executed(
    server: Server, request_body: Body
) -> None:
    put(server, POSE)
    found = plan(server, in_camera(request_body))
    put(server, {**POSE, "position_m": [0, 0, 0]}, 200)
    assert server.client.get(f"/v1/plans/{found['id']}").json() == found
    server.client.delete(PATH)
    assert server.client.get(f"/v1/plans/{found['id']}").json() == found

    request, answer = stored(server, found["id"])
    kept = json.loads(request)
    assert (kept["frame"], kept["frame_transform"]) == ("camera", POSE)
    for own, sent in zip(kept["targets"], request_body["targets"], strict=True):
        assert own["position_m"] == pytest.approx(sent["position_m"])
    motions = target_motions(request, answer, "0" * 32)
    assert isinstance(motions, tuple)
    for motion, approach in zip(motions, found["approaches"], strict=True):
        message = decode_from_service(motion)
        assert isinstance(message, TargetMotion)
        assert message.thinning_joints == pytest.approx(approach["thinning_joints"])


def test_faults_of_a_request_in_a_frame_point_to_what_was_sent(
    server: Server, request_body: Body
) -> None:
    put(server, POSE)
    body = in_camera(request_body)
    body["targets"][1]["position_m"] = [250.0, 40.0, 500.0]
    body["targets"][2]["branch_direction"] = [0, 0, 0]
    body["targets"][3]["position_m"] = [0.1, 0.2]
    problem = assert_problem(server.client.post("/v1/plans", json=body), 422)
    assert {error["pointer"] for error in problem["errors"]} == {
        "#/targets/1/position_m", "#/targets/2/branch_direction", "#/targets/3/position_m",
    }  # fmt: skip
    # Within 20 times the reach of the base, as far as only the frame knows.
    put(server, {**POSE, "position_m": [1000.0, 0, 0]}, 200)
    body = in_camera(request_body)
    for target in body["targets"]:
        target["position_m"][2] -= 1000.25
    assert plan(server, body)["summary"]["planned"] == 5


def test_the_pose_that_was_used_cannot_be_sent(server: Server, request_body: Body) -> None:
    body = {**request_body, "frame": "camera", "frame_transform": POSE}
    answer = server.client.post("/v1/plans", json=body)
    assert_problem(answer, 422, "#/frame_transform")


@pytest.mark.parametrize("name", [MARKER, "", "../base", "x" * 1000, "Base", "a\x00b"])
def test_frames_that_are_not_there(server: Server, request_body: Body, name: str) -> None:
    answer: httpx2.Response = server.client.post("/v1/plans", json={**request_body, "frame": name})
    assert_problem(answer, 422, "#/frame")
    assert MARKER not in answer.text


def test_without_a_service_there_is_base_only(tmp_path: Any) -> None:
    body = {**json.loads(EXAMPLE.read_text()), "frame": "camera"}
    with pytest.raises(InvalidProblem) as raised:
        problem_from_wire(parse_request(json.dumps(body).encode()))
    (fault,) = raised.value.faults
    assert fault.pointer == "#/frame"
    file = tmp_path / "request.json"
    file.write_text(json.dumps(body))
    finished = run("plan", str(file))
    assert finished.returncode == 2
    assert "#/frame" in finished.stderr
    assert "PUT /v1/frames/NAME" in finished.stderr.replace("\n", " ")
