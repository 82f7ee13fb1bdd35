"""Batches that hold up the process that parses them."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import orjson
import pytest

from app.services.plans.batch_reading import LARGE_BODY_BYTES
from tests.app.conftest import BODY_LIMIT_BYTES, Server, assert_problem

MILLION = 1_000_000
LIMIT = 100_000  # of targets, by default
MOST_GROWTH_KIB = 200 * 1024


def batch(count: int, **changes: Any) -> dict[str, Any]:
    targets = [
        {"id": f"{k}", "position_m": [9, 0, 0], "branch_direction": [0, 0, 1]} for k in range(count)
    ]
    options = {"method": "fixed_z", "order": "independent"}
    return {"robot": "tabletop", "targets": targets, "options": options, **changes}


def post(server: Server, body: dict[str, Any], **headers: str) -> httpx2.Response:
    content = orjson.dumps(body)
    assert len(content) > LARGE_BODY_BYTES
    return server.client.post(
        "/v1/plans", content=content, headers={"Content-Type": "application/json", **headers}
    )


def processor_s(pid: int) -> float:
    """What a process has had of the processors."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def computed_elsewhere(server: Server) -> Iterator[None]:
    """The block leaves its computing to a solver process; the service answers others meanwhile.

    Told by processor time, which is the same on a machine that does much else.
    """
    done, answered = threading.Event(), []

    def ask() -> None:
        with httpx2.Client(base_url=server.url, trust_env=False) as client:
            while not done.wait(0.05):
                answered.append(client.get("/healthz").status_code)

    solvers = server.children()
    own = -processor_s(server.process.pid)
    theirs = -sum(map(processor_s, solvers))
    asking = threading.Thread(target=ask)
    asking.start()
    try:
        yield
    finally:
        done.set()
        asking.join()
    own += processor_s(server.process.pid)
    theirs += sum(map(processor_s, solvers))
    assert own < theirs / 2, (own, theirs)
    assert len(answered) > 3
    assert set(answered) == {200}


def resident_kib(server: Server) -> int:
    status = Path(f"/proc/{server.process.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0])


def test_a_million_tiny_targets(server: Server) -> None:
    before = resident_kib(server)
    with computed_elsewhere(server):
        problem = assert_problem(post(server, batch(0, targets=[{}] * MILLION)), 422)
        # Lists stop at their first fault.
        assert len(problem["errors"]) == 3
        # As many as fit are read to the end, and refused for their number.
        assert_problem(post(server, batch(LIMIT + 1)), 422, "#/targets")
        assert_problem(post(server, batch(MILLION // 5)), 413)
    assert resident_kib(server) - before < MOST_GROWTH_KIB
    assert server.client.get("/readyz").status_code == 200


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"robot": "nobody"}, "#/robot"),
        ({"frame": "nowhere"}, "#/frame"),
        ({"more": 1}, "#/more"),
        ({"options": {"path_points": 1}}, "#/options/path_points"),
    ],
)
def test_faults_are_pointed_to_as_in_small_ones(
    changes: dict[str, Any], pointer: str, server: Server
) -> None:
    assert_problem(post(server, batch(6000, **changes)), 422, pointer)


def test_what_is_no_json_is_told(server: Server) -> None:
    headers = {"Content-Type": "application/json"}
    cut = orjson.dumps(batch(6000))[:-10]
    assert_problem(server.client.post("/v1/plans", content=cut, headers=headers), 422)
    deep = b"[" * (BODY_LIMIT_BYTES // 2)
    assert_problem(server.client.post("/v1/plans", content=deep, headers=headers), 422)


def test_a_large_batch_in_a_frame_becomes_a_job(server: Server) -> None:
    pose = {"position_m": [-9.0, 0.0, 0.3], "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    assert server.client.put("/v1/frames/large", json=pose).status_code in (200, 201)
    answer = post(server, batch(6000, frame="large"))
    assert answer.status_code == 202, answer.text
    job = answer.json()
    assert job["targets"] == 6000
    server.client.delete(answer.headers["location"])
    server.client.delete("/v1/frames/large")


def test_a_million_blossoms(server: Server) -> None:
    points = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]
    blossoms = [{"id": f"{k}", "distance_m": 0.0} for k in range(MILLION // 6)]
    body = {"branches": [{"id": "b", "points_m": points, "blossoms": blossoms}]}
    path, content = "/v1/thinning-selections", orjson.dumps(body)
    assert LARGE_BODY_BYTES < len(content) <= BODY_LIMIT_BYTES
    headers = {"Content-Type": "application/json"}
    with computed_elsewhere(server):
        answer = server.client.post(path, content=content, headers=headers)
        assert len(answer.json()["targets"]) == len(blossoms)
        body["branches"][0]["points_m"] = [[0.0, 0.0, 0.0]]
        broken = server.client.post(path, content=orjson.dumps(body), headers=headers)
        assert_problem(broken, 422, "#/branches/0/points_m")


def test_a_large_body_for_few_targets_is_answered_at_once(server: Server) -> None:
    body = batch(1)
    body["targets"][0]["id"] = "x" * (LARGE_BODY_BYTES + 1)
    answer = post(server, body)
    assert answer.status_code == 201
    assert answer.json()["approaches"][0]["target_id"] == body["targets"][0]["id"]
