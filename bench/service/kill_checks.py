"""What must be true after the deaths: all that was answered is there, once and unchanged."""

import hashlib
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import orjson
from sqlalchemy import Engine, Table, func, select

from app.store.tables import EXECUTIONS, IDEMPOTENCY_KEYS, JOBS, PLAN_PARTS, PLANS
from bench.service.kill_load import ROBOT, Answered, NeverGivingUp

JOB_S = 900.0
POLL_S = 0.2
Parts = dict[tuple[str, int], str]


def stored_parts(engine: Engine) -> Parts:
    """A digest of every part of a job that is stored."""
    query = select(PLAN_PARTS)
    with engine.connect() as connection:
        return {
            (row.plan_id, row.number): hashlib.sha256(repr(tuple(row)).encode()).hexdigest()
            for row in connection.execute(query)
        }


def count_parts(engine: Engine) -> int:
    """How many parts of jobs are stored."""
    with engine.connect() as connection:
        return connection.scalar(select(func.count()).select_from(PLAN_PARTS)) or 0


def changed_parts(before: Parts, after: Parts) -> list[str]:
    """Parts that were solved and stored anew, or are gone."""
    return [
        f"part {number} of job {job} was stored again or lost"
        for (job, number), digest in before.items()
        if after.get((job, number)) != digest
    ]


def check_answers(service: NeverGivingUp, answered: Iterable[Answered]) -> list[str]:
    """Every answer once more: from where it said it would be, and by its key."""
    found = []
    for one in answered:
        again, _ = service.send(
            "POST", one.path, one.body,
            **{"Idempotency-Key": one.key, "Content-Type": "application/json"},
        )  # fmt: skip
        if (again.status_code, again.content) != (one.status, one.content):
            found.append(f"the key of {one.location} has another answer, {again.status_code}")
        if "idempotency-replayed" not in again.headers:
            found.append(f"the key of {one.location} was not known")
        read, _ = service.send("GET", one.location)
        if read.status_code != 200:
            found.append(f"{one.location} is lost: {read.status_code}")
        elif one.kind == "plan" and read.content != one.content:
            found.append(f"{one.location} is not as it was answered")
    return found


def check_rows(engine: Engine, answered: Iterable[Answered]) -> list[str]:
    """One row a key, one key a row, and none that nobody asked for."""
    answered, found = list(answered), []
    with engine.connect() as connection:
        keys = connection.execute(select(IDEMPOTENCY_KEYS.c.key, IDEMPOTENCY_KEYS.c.location)).all()
    if {(row.key, row.location) for row in keys} != {(one.key, one.location) for one in answered}:
        found.append("the stored keys are not those that were answered")
    if twice := [where for where, n in Counter(row.location for row in keys).items() if n > 1]:
        found.append(f"under several keys: {twice}")
    for table, kind in ((PLANS, "plan"), (JOBS, "job"), (EXECUTIONS, "execution")):
        ids = _ids(engine, table)
        wanted = {one.location.rpartition("/")[2] for one in answered if one.kind == kind}
        if lost := wanted - ids:
            found.append(f"{len(lost)} answered {kind}s have no row")
        if more := ids - wanted:
            found.append(f"{len(more)} {kind}s have a row but were created twice or without a key")
    return found


def _ids(engine: Engine, table: Table) -> set[str]:
    query = select(table.c.id)
    if table is PLANS:
        query = query.where(~PLANS.c.in_parts)
    with engine.connect() as connection:
        return set(connection.execute(query).scalars())


def check_jobs(service: NeverGivingUp, answered: Iterable[Answered]) -> list[str]:
    """Every job completes, with every target once."""
    found, deadline = [], time.monotonic() + JOB_S
    for one in answered:
        if one.kind != "job":
            continue
        while True:
            job = service.send("GET", one.location)[0].json()
            if job["status"] not in ("queued", "running") or time.monotonic() > deadline:
                break
            time.sleep(POLL_S)
        if job["status"] != "completed" or job["done"] != one.targets:
            found.append(f"{one.location} is {job['status']} with {job['done']} done")
            continue
        plan = service.send("GET", f"/v1/plans/{job['plan_id']}")[0].json()
        ids = sorted(int(approach["target_id"]) for approach in plan["approaches"])
        if ids != list(range(one.targets)):
            found.append(f"the plan of {one.location} has not every target once")
    return found


def check_worker(folder: Path, engine: Engine) -> tuple[list[str], int]:
    """Nothing begun twice, by the worker's own record; and how many were begun."""
    lines = (folder / f"{ROBOT}.journal").read_bytes().splitlines()
    begun = Counter(
        entry["execution_id"] for entry in map(orjson.loads, lines) if entry["event"] == "started"
    )
    found = [
        f"execution {name} was begun {count} times" for name, count in begun.items() if count > 1
    ]
    if unknown := set(begun) - _ids(engine, EXECUTIONS):
        found.append(f"{len(unknown)} executions were begun that are not stored")
    changes = (folder / "laser.txt").read_text().splitlines()
    lit = sum(line.split()[1] == "on" for line in changes)
    # Each has one target.
    if lit > len(begun):
        found.append(f"the laser was on {lit} times in {len(begun)} executions")
    return found, len(begun)
