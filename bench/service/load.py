"""`python -m bench.service.load`: a live server of its own, loaded from this process."""

import argparse
import asyncio
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import orjson

from app.services.solving.long_lived import keep_for_good
from bench.measure import Row, failed, row
from bench.registry import SERVICE
from bench.results import FOLDER, write_and_print
from bench.service.batches import Batches
from bench.service.client import Client
from bench.service.memory import sample, slope_kib_per_min
from bench.service.mixed import Tally, mixed_load
from solver.comparison.machine import machine

REACHABLE_MS: Final = 90.0
REFUSED_MS: Final = 150.0
GIVEN_MS: Final = 200.0
NCOS_OVERHEAD_PERCENT: Final = 15.0
P99_MS: Final = 25.0
RATE_HZ: Final = 100
JOB_TARGETS: Final = 10_000
SAMPLE_S: Final = 5.0
WARMING_SHARE: Final = 0.2
"""Of the mixed load's time, left out of the slope: caches and heaps fill first."""
READY_S: Final = 600


def main() -> int:
    """Measures, writes bench/results/service.json; 1 if a figure is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mixed-s", type=float, default=1800)
    parser.add_argument("--single-s", type=float, default=30)
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--output", type=Path, default=FOLDER)
    given = parser.parse_args()
    about, began = machine(), time.perf_counter()
    # The load must not hold itself up: a collection of all that is imported here takes 0.1 s.
    keep_for_good()
    with live_server() as (pid, port):
        rows = asyncio.run(_measure(pid, port, given))
    quick = given.mixed_s < 1800
    elapsed_s = time.perf_counter() - began
    return write_and_print(given.output, SERVICE, rows, about, quick=quick, elapsed_s=elapsed_s)


@contextlib.contextmanager
def live_server(settings: Mapping[str, str] | None = None) -> Iterator[tuple[int, int]]:
    """A service with an empty data folder, warm; its process id and port.

    Args:
        settings: more of its environment.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "app", "serve", "--port", "0", "--data-dir", folder]
        environment = {**os.environ, "PRUNUS_LOG_LEVEL": "warning", **(settings or {})}
        with subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, text=True
        ) as process:
            try:
                assert process.stdout is not None
                url = process.stdout.readline().split()[-1]
                _await_ready(url)
                yield process.pid, int(url.rpartition(":")[2])
            finally:
                process.terminate()
                process.wait(60)


def _await_ready(url: str) -> None:
    deadline = time.monotonic() + READY_S
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError), urllib.request.urlopen(f"{url}/readyz"):
            return
        time.sleep(0.2)
    raise TimeoutError("the service does not become ready")


async def _measure(pid: int, port: int, given: argparse.Namespace) -> list[Row]:
    client = Client("127.0.0.1", port)
    rows = [*await _batches(client, given.runs), *await _singles(client, given.single_s)]
    samples: list[tuple[float, int]] = []
    sampling = asyncio.create_task(sample(pid, SAMPLE_S, samples))
    until = time.monotonic() + given.mixed_s
    tally = await mixed_load(client, lambda _: time.monotonic() < until, 6, compare=True)
    sampling.cancel()
    client.close()
    return [*rows, *mixed_rows(tally, samples, given.mixed_s)]


async def _batches(client: Client, runs: int) -> list[Row]:
    kinds = (
        ("1,000 independent targets by ssas, all reachable, whole request", "independent", True,
         REACHABLE_MS),
        ("the same with targets as they come, a fifth of them refused", "independent", False,
         REFUSED_MS),
        ("1,000 targets in a given order by ssas, all reachable", "given", True, GIVEN_MS),
    )  # fmt: skip
    rows: list[Row] = []
    for name, order, reachable, wanted in kinds:
        whole_ms = await _whole_ms(client, order, reachable, runs)
        rows.append(row(name, whole_ms, "ms", at_most=wanted))
    overhead = await _ncos_overhead_percent(client, max(3, runs // 3))
    name = "1,000 targets by ncos, request above the solver's own time"
    return [*rows, row(name, overhead, "%", at_most=NCOS_OVERHEAD_PERCENT)]


async def _whole_ms(client: Client, order: str, reachable: bool, runs: int) -> list[float]:
    batches, times = Batches(1), []
    make = batches.reachable_body if reachable else batches.body
    for _ in range(runs + 1):
        body = make(1000, "ssas", order=order, position_margin_m=0.0)
        began = time.perf_counter()
        await _posted(client, body)
        times.append(1e3 * (time.perf_counter() - began))
    return times[1:]  # the first one fills caches


async def _ncos_overhead_percent(client: Client, runs: int) -> list[float]:
    batches, found = Batches(1), []
    for _ in range(runs):
        body = batches.body(1000, "ncos")
        began = time.perf_counter()
        answer = await _posted(client, body)
        elapsed_s = time.perf_counter() - began
        found.append(100 * (elapsed_s / orjson.loads(answer)["summary"]["elapsed_s"] - 1))
    return found


async def _posted(client: Client, body: bytes) -> bytes:
    answer = await client.request("POST", "/v1/plans", body)
    if answer.status != 201:
        raise RuntimeError(f"POST /v1/plans was answered with {answer.status}")
    return answer.body


async def _singles(client: Client, duration_s: float) -> list[Row]:
    name = f"one target by ssas, {RATE_HZ} a second while a {JOB_TARGETS:,}-target job runs, p99"
    batches = Batches(2)
    body = batches.body(JOB_TARGETS, "ncos", include=[])
    answer = await client.request("POST", "/v1/plans", body, {"Prefer": "respond-async"})
    if answer.status != 202:
        why = f"the job was answered with {answer.status}"
        return [failed(name, "ms", why, f"<= {P99_MS:g}")]
    where = answer.headers["location"]
    began = time.perf_counter()
    tasks = []
    for index in range(int(duration_s * RATE_HZ)):
        scheduled = began + index / RATE_HZ
        await asyncio.sleep(max(0.0, scheduled - time.perf_counter()))
        tasks.append(asyncio.create_task(_single(client, batches.body(1, "ssas"), scheduled)))
    times = await asyncio.gather(*tasks)
    state = orjson.loads((await client.request("GET", where)).body)["status"]
    await client.request("DELETE", where)
    lost = sum(time_ms is None for time_ms in times)
    known = sorted(time_ms for time_ms in times if time_ms is not None)
    if lost or not known:
        return [failed(name, "ms", f"{lost} of {len(times)} failed", f"<= {P99_MS:g}")]
    note = f"from the scheduled time; median {known[len(known) // 2]:.1f}, max {known[-1]:.1f} ms; "
    note += f"the job was {state} at the end"
    p99 = known[int(0.99 * len(known))]
    return [row(name, p99, "ms", runs=len(known), at_most=P99_MS, note=note)]


async def _single(client: Client, body: bytes, scheduled: float) -> float | None:
    try:
        answer = await client.request("POST", "/v1/plans", body)
    except (OSError, asyncio.IncompleteReadError):
        return None
    return 1e3 * (time.perf_counter() - scheduled) if answer.status == 201 else None


def mixed_rows(tally: Tally, samples: list[tuple[float, int]], duration_s: float) -> list[Row]:
    """What a mixed load came to."""
    counts: dict[str, Any] = {**tally.done, "provoked": dict(tally.provoked)}
    skip_s = WARMING_SHARE * duration_s
    slope = slope_kib_per_min(samples, skip_s)
    late = [kib for at, kib in samples if at >= skip_s]
    return [
        row(
            f"errors not provoked in {duration_s / 60:g} min of mixed load",
            tally.errors,
            "",
            at_most=0,
            note="; ".join([json.dumps(counts), *tally.notes]),
        ),
        row(
            "slope of the memory of the service and its processes",
            slope,
            "KiB/min",
            note=f"first {skip_s:g} s left out; then {min(late)} to {max(late)} KiB resident",
        ),
    ]


if __name__ == "__main__":
    sys.exit(main())
