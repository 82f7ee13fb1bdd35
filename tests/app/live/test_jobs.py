import contextlib
import json
import os
import re
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from tests.app.conftest import JOB_S, Server, assert_problem, running_server, wait_until
from tests.solver.problems import random_targets

Body = dict[str, Any]
ASYNC = {"Prefer": "respond-async"}
CLOCKS = ("id", "elapsed_s", "solver")


def batch(count: int, method: str, order: str = "independent", **options: Any) -> Body:
    targets = [
        {
            "id": target.id,
            "position_m": list(target.position_m),
            "branch_direction": list(target.branch_direction),
        }
        for target in random_targets(seed=61, count=count)
    ]
    options = {"method": method, "order": order, "include": ["path"], **options}
    return {"robot": "tabletop", "targets": targets, "options": options}


@pytest.fixture(scope="module")
def jobs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with running_server(
        tmp_path_factory.mktemp("jobs"),
        PRUNUS_SYNC_TARGETS_LIMIT="300",
        PRUNUS_JOB_TARGETS_LIMIT="3000",
        PRUNUS_MOST_WAITING_JOBS="3",
    ) as server:
        yield server


def begun(server: Server, body: Body, **headers: str) -> Body:
    answer = server.client.post("/v1/plans", json=body, headers={**ASYNC, **headers})
    assert answer.status_code == 202, answer.text
    job: Body = answer.json()
    assert answer.headers["location"] == f"/v1/jobs/{job['id']}"
    assert job["status"] == "queued"
    assert (job["done"], job["planned"], job["infeasible"]) == (0, 0, 0)
    return job


def job_of(server: Server, job_id: str) -> Body:
    answer = server.client.get(f"/v1/jobs/{job_id}")
    assert answer.status_code == 200
    job: Body = answer.json()
    return job


def ended(server: Server, job_id: str) -> Body:
    wait_until(lambda: "ended_at" in job_of(server, job_id), JOB_S)
    return job_of(server, job_id)


def without_clocks(plan: Body) -> Body:
    kept = {name: value for name, value in plan.items() if name not in CLOCKS}
    kept["summary"] = {n: v for n, v in plan["summary"].items() if n not in CLOCKS}
    kept["approaches"] = [
        {name: value for name, value in entry.items() if name not in CLOCKS}
        for entry in plan["approaches"]
    ]
    return kept


@pytest.mark.parametrize(
    ("method", "order", "count"),
    [("ssas", "independent", 270), ("ncos", "given", 60), ("ssas", "optimal", 260)],
)
def test_a_job_makes_the_plan_of_a_request(
    jobs: Server, method: str, order: str, count: int
) -> None:
    body = batch(count, method, order)
    job = ended(jobs, begun(jobs, body)["id"])
    assert (job["status"], job["done"], job["targets"]) == ("completed", count, count)
    at_once = jobs.client.post("/v1/plans", json=body)
    assert at_once.status_code == 201
    answer = jobs.client.get(f"/v1/plans/{job['plan_id']}")
    plan = answer.json()
    assert plan["id"] == job["id"]
    expected = without_clocks(at_once.json())
    # Sums of sums round differently.
    effort = expected["summary"].pop("total_effort")
    found = without_clocks(plan)
    assert found["summary"].pop("total_effort") == pytest.approx(effort)
    assert found == expected
    assert (job["planned"], job["infeasible"]) == (
        plan["summary"]["planned"],
        plan["summary"]["infeasible"],
    )
    lines = jobs.client.get(
        f"/v1/plans/{job['id']}", headers={"Accept": "application/x-ndjson"}
    ).text.splitlines()
    assert [json.loads(line) for line in lines] == plan["approaches"]


def test_large_batches_become_jobs_and_larger_ones_are_refused(jobs: Server) -> None:
    answer = jobs.client.post("/v1/plans", json=batch(301, "ssas"))
    assert answer.status_code == 202
    assert "preference-applied" not in answer.headers
    assert ended(jobs, answer.json()["id"])["status"] == "completed"
    refused = jobs.client.post("/v1/plans", json=batch(3001, "ssas"))
    assert_problem(refused, 422, "#/targets")


def test_results_and_events_come_while_it_runs(jobs: Server) -> None:
    job = begun(jobs, batch(2000, "ncos"))
    path = f"/v1/jobs/{job['id']}"
    wait_until(lambda: job_of(jobs, job["id"])["done"] > 0, JOB_S)
    so_far = jobs.client.get(f"{path}/results").json()["approaches"]
    assert 0 < len(so_far) < 2000
    events: list[tuple[str, Body]] = []

    def follow() -> None:
        with (
            httpx2.Client(base_url=jobs.url, timeout=JOB_S, trust_env=False) as client,
            client.stream("GET", f"{path}/events") as answer,
        ):
            assert answer.headers["content-type"].startswith("text/event-stream")
            text = "".join(answer.iter_text())
        for name, data in re.findall(r"event: (\w+)\nid: \d+\ndata: (.*)\n\n", text):
            events.append((name, json.loads(data)))

    follower = threading.Thread(target=follow)
    follower.start()
    seen = 0
    with jobs.client.stream(
        "GET", f"{path}/results", headers={"Accept": "application/x-ndjson"}
    ) as answer:
        for line in answer.iter_lines():
            assert json.loads(line)["target_id"] == str(seen)
            seen += 1
            if seen == len(so_far) + 100:
                canceled = httpx2.delete(f"{jobs.url}{path}", trust_env=False)
                assert canceled.status_code == 202
                assert canceled.json()["status"] == "canceled"
    follower.join(JOB_S)
    job = job_of(jobs, job["id"])
    assert seen == job["done"] < 2000
    assert [name for name, _ in events] == ["progress"] * (len(events) - 1) + ["ended"]
    done = [data["done"] for _, data in events]
    assert done == sorted(done)
    assert events[-1][1] == job
    assert_problem(jobs.client.get(f"/v1/plans/{job['id']}"), 404)
    assert_problem(jobs.client.delete(path), 409)
    assert len(jobs.client.get(f"{path}/results").json()["approaches"]) == seen


def test_a_batch_that_is_choosing_is_canceled_and_the_next_one_runs(jobs: Server) -> None:
    slow = begun(jobs, batch(2000, "ssas", "optimal"))
    waiting = begun(jobs, batch(2000, "ssas", "optimal"))
    wait_until(lambda: job_of(jobs, slow["id"])["status"] == "running", JOB_S)
    assert jobs.client.delete(f"/v1/jobs/{waiting['id']}").json()["status"] == "canceled"
    assert jobs.client.delete(f"/v1/jobs/{slow['id']}").json()["status"] == "canceled"
    after = ended(jobs, begun(jobs, batch(20, "ssas"))["id"])
    assert after["status"] == "completed"
    listed = [job["id"] for job in jobs.client.get("/v1/jobs").json()["jobs"]]
    assert listed[:3] == [after["id"], waiting["id"], slow["id"]]


def test_too_many_jobs_are_refused_and_unknown_ones_are_404(jobs: Server) -> None:
    first = [begun(jobs, batch(2000, "ncos"))["id"] for _ in range(3)]
    refused = jobs.client.post("/v1/plans", json=batch(10, "ssas"), headers=ASYNC)
    problem = assert_problem(refused, 503)
    assert problem["type"].endswith("jobs_full")
    assert int(refused.headers["retry-after"]) > 0
    for job_id in first:
        assert jobs.client.delete(f"/v1/jobs/{job_id}").status_code == 202
    for path in ("", "/events", "/results"):
        assert_problem(jobs.client.get(f"/v1/jobs/{'0' * 32}{path}"), 404)
    assert_problem(jobs.client.delete("/v1/jobs/nonsense"), 404)


def test_a_key_gives_the_first_answer_again(jobs: Server) -> None:
    key = {"Idempotency-Key": "a-job"}
    first = begun(jobs, batch(10, "ssas"), **key)
    ended(jobs, first["id"])
    again = jobs.client.post("/v1/plans", json=batch(10, "ssas"), headers={**ASYNC, **key})
    assert (again.status_code, again.json()) == (202, first)
    assert again.headers["idempotency-replayed"] == "true"


def job_processes(server: Server) -> set[int]:
    """Those that yield to the service."""
    of_service = os.getpriority(os.PRIO_PROCESS, server.process.pid)
    found = set()
    for pid in server.children():
        with contextlib.suppress(ProcessLookupError):
            if os.getpriority(os.PRIO_PROCESS, pid) > of_service:
                found.add(pid)
    return found


def test_a_job_process_that_dies_is_started_again(jobs: Server) -> None:
    job = begun(jobs, batch(1500, "ncos"))
    wait_until(lambda: job_of(jobs, job["id"])["done"] > 0, JOB_S)
    # As when memory runs out: whatever comes is killed, for a while.
    gone: set[int] = set()
    for _ in range(3):
        wait_until(lambda: bool(job_processes(jobs) - gone), JOB_S)
        for worker in job_processes(jobs) - gone:
            os.kill(worker, signal.SIGKILL)
            gone.add(worker)
    done = job_of(jobs, job["id"])["done"]
    wait_until(lambda: job_of(jobs, job["id"])["done"] > done, JOB_S)
    assert jobs.client.delete(f"/v1/jobs/{job['id']}").json()["status"] == "canceled"


def test_a_job_goes_on_behind_its_last_part(tmp_path: Path) -> None:
    """Through two deaths: killed, and stopped."""
    log = tmp_path / "log"
    with log.open("w") as stderr:
        with running_server(tmp_path / "data", stderr=stderr) as server:
            job = begun(server, batch(200, "ncos"))
            end_over_job(server, job, 50, signal.SIGKILL)
        with running_server(tmp_path / "data", stderr=stderr) as server:
            end_over_job(server, job, 100, signal.SIGTERM)
        with running_server(tmp_path / "data", stderr=stderr) as server:
            finished = ended(server, job["id"])
            assert (finished["status"], finished["done"]) == ("completed", 200)
            plan = server.client.get(f"/v1/plans/{job['id']}").json()
            expected = [str(k) for k in range(200)]
            assert [entry["target_id"] for entry in plan["approaches"]] == expected
    stored: set[int] = set()
    # Python's resource tracker complains in plain text of a parent that was killed.
    lines = [line for line in log.read_text().splitlines() if line.startswith("{")]
    for entry in map(json.loads, lines):
        if entry["event"] == "job part started":
            assert entry["part"] not in stored, "solved again"
        if entry["event"] == "job part stored":
            assert entry["part"] not in stored, "stored again"
            stored.add(entry["part"])
    assert stored == set(range(4))


def end_over_job(server: Server, job: Body, done: int, kind: signal.Signals) -> None:
    """End the service when so many targets are done, while somebody reads the results along."""
    wait_until(lambda: job_of(server, job["id"])["done"] >= done, JOB_S)
    assert job_of(server, job["id"])["done"] < job["targets"], "it was over too soon"
    # Whoever reads along must not take what comes until then for all.
    path, following = f"/v1/jobs/{job['id']}/results", {"Accept": "application/x-ndjson"}
    with server.client.stream("GET", path, headers=following) as answer:
        coming = answer.iter_lines()
        next(coming)
        server.process.send_signal(kind)
        with pytest.raises(httpx2.RemoteProtocolError):
            list(coming)
    server.process.wait(60)
