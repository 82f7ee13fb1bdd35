"""`python -m bench.service.kills [--rounds N] [--database NAME]...`: kill -9 under load.

Clients post plans, jobs and executions, each with a key, and repeat a request until it is answered.
Meanwhile the service and its solver processes are killed at random moments and started again. Then
every answer is asked for again, and the rows and the worker's journal are counted. Prints a JSON
object a database; the exit code is 1 if anything was lost, or done twice. A database is `sqlite`,
`postgresql` (a server of one's own, from the distribution's packages), or an SQLAlchemy URL of an
empty one.
"""

import argparse
import json
import random
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, create_engine, inspect

from app.server.processes import own_process
from app.settings import Settings
from bench.measure import Row, row
from bench.registry import KILLS
from bench.results import FOLDER, write_and_print
from bench.service.kill_checks import (
    Parts,
    changed_parts,
    check_answers,
    check_jobs,
    check_rows,
    check_worker,
    count_parts,
    stored_parts,
)
from bench.service.kill_load import (
    ROBOT,
    Account,
    ExecutionClient,
    JobClient,
    LoadClient,
    NeverGivingUp,
)
from bench.service.killed_service import DATA, KilledService
from bench.service.postgresql import INSTALL, PostgresqlServer, find_programs
from solver.comparison.machine import machine

SQLITE, POSTGRESQL = "sqlite", "postgresql"
ROUNDS = 100
# The moments of death: while it starts, while its kernels warm up with requests waiting, while it
# answers, and when it has just stored a part of a job, of which a short life sees none: the process
# for jobs starts last. Each at random within so many seconds.
STARTING, WARMING, ANSWERING, BETWEEN_PARTS = "starting", "warming", "answering", "between_parts"
SHARES = {STARTING: 0.1, WARMING: 0.1, ANSWERING: 0.4, BETWEEN_PARTS: 0.4}
WITHIN_S = {STARTING: 2.0, WARMING: 2.0, ANSWERING: 1.5, BETWEEN_PARTS: 0.3}
PART_S = 600.0  # jobs take what is left of the processors
PART_POLL_S = 0.02
TIME_FACTOR = "8"
FIRST_LINE_S = 60.0
JOIN_S = 1800.0
PLAN_CLIENTS = 3


@dataclass(frozen=True)
class Trial:
    """What is tried.

    Attributes:
        rounds: how often the service is killed.
        database_url: an SQLAlchemy URL; empty: SQLite in the folder.
        folder: of everything that is written.
    """

    rounds: int
    database_url: str
    folder: Path
    seed: int = 0


class DatabaseNotEmpty(Exception):
    """The database has tables already; rows of others cannot be told from rows too many."""


def kill_rounds(trial: Trial) -> dict[str, Any]:
    """The report: what was answered, and `violations`, which is empty if all is well.

    Raises:
        DatabaseNotEmpty: it has tables.
        ServiceDied: the service ended by itself.
    """
    # As the service reads it, which also says by which driver.
    settings = Settings(database_url=trial.database_url, data_dir=trial.folder / DATA)
    url = settings.resolved_database_url
    engine = create_engine(url)
    if trial.database_url and inspect(engine).get_table_names():
        raise DatabaseNotEmpty(url.render_as_string(hide_password=True))
    service = KilledService(trial.folder, trial.database_url)
    account, stopping = Account(), threading.Event()
    shared = (service.url, trial.seed, account, stopping)
    clients = [LoadClient(f"plans {number}", *shared) for number in range(PLAN_CLIENTS)]
    clients += [JobClient("jobs", *shared), ExecutionClient("executions", *shared)]
    started = time.monotonic()
    with ExitStack() as stack:
        stack.callback(engine.dispose)
        stack.callback(stopping.set)
        stack.callback(service.kill)
        service.start()
        # Or every life would compile kernels, and none would get to solving.
        service.wait_until_ready()
        _start_arm(stack, service.url, trial.folder)
        for client in clients:
            client.start()
        violations, deaths = _deaths(trial, service, engine)
        service.start()
        service.wait_until_healthy()
        stopping.set()
        for client in clients:
            client.join(JOIN_S)
            if client.is_alive():
                violations.append(f"the client of {client.name} is still waiting")
        caller = NeverGivingUp(service.url)
        stack.callback(caller.close)
        answered = list(account.answered)
        violations += account.unexpected
        violations += check_jobs(caller, answered)
        violations += check_answers(caller, answered)
        violations += check_rows(engine, answered)
        of_worker, begun = check_worker(trial.folder, engine)
        violations += of_worker
        parts = len(stored_parts(engine))
    return {
        "database": url.get_backend_name(),
        "rounds": trial.rounds,
        "seed": trial.seed,
        "killed_while": deaths,
        "answered": dict(Counter(one.kind for one in answered)),
        "sent_again": sum(one.attempts > 1 for one in answered),
        "answers_lost_and_replayed": sum(one.replayed for one in answered),
        "job_parts": parts,
        "executions_begun": begun,
        "elapsed_s": round(time.monotonic() - started, 1),
        "violations": violations,
    }


def _start_arm(stack: ExitStack, url: str, folder: Path) -> None:
    bus = stack.enter_context(own_process("servo-bus", "--time-factor", TIME_FACTOR))
    device = bus.first_line(FIRST_LINE_S)
    record = folder / "laser.txt"
    stack.enter_context(
        own_process(
            "worker", "--url", url, "--robot", ROBOT, "--port", device,
            "--data-dir", str(folder), "--time-factor", TIME_FACTOR,
            "--end-effector", "simulated", "--end-effector-record", str(record),
        )
    )  # fmt: skip


def _deaths(
    trial: Trial, service: KilledService, engine: Engine
) -> tuple[list[str], dict[str, int]]:
    """Kill and start again; what was wrong with the parts of jobs, and when the service died."""
    moments = random.Random(trial.seed)
    order = _order(trial.rounds, moments)
    found: list[str] = []
    parts: Parts = {}
    deaths = dict.fromkeys(SHARES, 0)
    for number in range(trial.rounds):
        if number:
            service.start()
        moment = order[number]
        if moment == WARMING:
            service.wait_until_healthy()
        elif moment == ANSWERING:
            service.wait_until_ready()
        elif moment == BETWEEN_PARTS:
            service.wait_until_healthy()
            _wait_for_part(engine, found)
        time.sleep(moments.uniform(0, WITHIN_S[moment]))
        service.kill()
        deaths[moment] += 1
        now = stored_parts(engine)
        found += changed_parts(parts, now)
        parts = now
    return found, deaths


def _order(rounds: int, moments: random.Random) -> list[str]:
    """The moments of death: each once, so that few rounds have them all, then by their shares."""
    drawn = moments.choices(list(SHARES), list(SHARES.values()), k=rounds)
    order = [*SHARES, *drawn[len(SHARES) :]][:rounds]
    moments.shuffle(order)
    return order


def _wait_for_part(engine: Engine, found: list[str]) -> None:
    before, deadline = count_parts(engine), time.monotonic() + PART_S
    while count_parts(engine) == before:
        if time.monotonic() > deadline:
            found.append(f"no part of a job was stored in {PART_S:g} s")
            return
        time.sleep(PART_POLL_S)


def main() -> int:
    """Prints the reports and writes bench/results/kills.json."""
    parser = argparse.ArgumentParser(prog="bench.service.kills", description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--database", action="append", help=f"default: {SQLITE}, {POSTGRESQL}")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=FOLDER)
    given = parser.parse_args()
    about, began = machine(), time.perf_counter()
    rows = []
    for database in given.database or (SQLITE, POSTGRESQL):
        with ExitStack() as stack:
            url = _url(stack, database)
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="prunus-kills-"))
            report = kill_rounds(Trial(given.rounds, url, Path(folder), given.seed))
        print(json.dumps(report, indent=2), flush=True)
        rows.append(_row(report))
    elapsed_s = time.perf_counter() - began
    quick = given.rounds < ROUNDS
    return write_and_print(given.output, KILLS, rows, about, quick=quick, elapsed_s=elapsed_s)


def _url(stack: ExitStack, database: str) -> str:
    if database == SQLITE:
        return ""
    if database != POSTGRESQL:
        return database
    programs = find_programs()
    if programs is None:
        sys.exit(f"PostgreSQL is not installed. {INSTALL}")
    server = PostgresqlServer.create(programs)
    stack.callback(server.remove)
    return server.new_database()


def _row(report: dict[str, Any]) -> Row:
    name = f"batches lost or done twice in {report['rounds']} kills on {report['database']}"
    told = ("answered", "sent_again", "answers_lost_and_replayed", "job_parts", "executions_begun")
    note = "; ".join([*report["violations"], json.dumps({name: report[name] for name in told})])
    return row(name, len(report["violations"]), "", at_most=0, note=note)


if __name__ == "__main__":
    sys.exit(main())
