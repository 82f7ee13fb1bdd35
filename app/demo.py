"""The demonstration: the service in a process of its own, data set 3, a table, two pictures."""

import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, Queue
from typing import Any

import httpx2
import orjson
from rich.console import Console

from app.demo_request import demo_request
from app.plan_table import markdown_table, print_plan

START_TIMEOUT_S = 120.0
STOP_TIMEOUT_S = 15.0
READY_LINE = "Prunus listens on "


class DemoFailed(Exception):
    """The demonstration cannot go on, and why."""


def run_demo(output: Path) -> int:
    """Run it; pictures, plan and table go to `output`. 0 only if all five targets are planned."""
    console, started = Console(), time.monotonic()

    def say(text: str) -> None:
        elapsed = time.monotonic() - started
        console.print(f"[{elapsed:5.1f} s] {text}", highlight=False, markup=False, soft_wrap=True)

    try:
        output.mkdir(parents=True, exist_ok=True)
        plan = _plan_over_http(output / "data", say)
        print_plan(plan, console)
        _write(output, plan, say)
    except (DemoFailed, OSError, httpx2.HTTPError) as error:
        say(f"the demonstration failed: {error}")
        return 1
    wanted = len(demo_request()["targets"])
    planned = int(plan["summary"]["planned"])
    say(f"{planned} of {wanted} targets planned and verified")
    return 0 if planned == wanted else 1


def _plan_over_http(data: Path, say: Any) -> dict[str, Any]:
    say("starting the service")
    with _service(data) as url, httpx2.Client(base_url=url, timeout=START_TIMEOUT_S) as client:
        say(f"it listens on {url}; waiting for its solver processes")
        _wait_until_ready(client)
        request = demo_request()
        say(f"posting {len(request['targets'])} targets to {url}/v1/plans")
        answer = client.post("/v1/plans", json=request)
        if answer.status_code != 201:
            raise DemoFailed(f"POST /v1/plans answered {answer.status_code}: {answer.text}")
        location = answer.headers["location"]
        say(f"201, kept as {location}; reading it back")
        plan: dict[str, Any] = client.get(location).raise_for_status().json()
    say("service stopped")
    return plan


@contextmanager
def _service(data: Path) -> Iterator[str]:
    command = [sys.executable, "-m", "app", "serve", "--port", "0", "--data-dir", str(data)]
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)
        try:
            yield _listening_url(process)
        except BaseException:
            errors.seek(0)
            sys.stderr.write(errors.read().decode(errors="replace"))
            raise
        finally:
            process.terminate()
            try:
                process.wait(STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdout:
                process.stdout.close()


def _listening_url(process: "subprocess.Popen[str]") -> str:
    lines: Queue[str] = Queue()
    stdout = process.stdout
    if stdout is None:
        raise DemoFailed("the service has no standard output")
    threading.Thread(target=lambda: lines.put(stdout.readline()), daemon=True).start()
    try:
        line = lines.get(timeout=START_TIMEOUT_S)
    except Empty:
        raise DemoFailed("the service did not say where it listens") from None
    if not line.startswith(READY_LINE):
        raise DemoFailed("the service ended before it listened")
    return line.removeprefix(READY_LINE).strip()


def _wait_until_ready(client: httpx2.Client) -> None:
    deadline = time.monotonic() + START_TIMEOUT_S
    while client.get("/readyz").status_code != 200:
        if time.monotonic() > deadline:
            raise DemoFailed("the service did not become ready")
        time.sleep(0.1)


def _write(output: Path, plan: dict[str, Any], say: Any) -> None:
    from app.pictures.arm import draw_arm
    from app.pictures.effort import draw_effort
    from app.services.wire import parse_request, problem_from_wire

    problem = problem_from_wire(parse_request(orjson.dumps(demo_request())))
    say("drawing the arm and the effort")
    for name, figure in (
        ("arm.png", draw_arm(plan, problem)),
        ("effort.png", draw_effort(plan, problem)),
    ):
        figure.savefig(output / name, dpi=130)
        say(f"wrote {output / name}")
    (output / "plan.json").write_bytes(orjson.dumps(plan, option=orjson.OPT_INDENT_2))
    (output / "table.md").write_text(markdown_table(plan), encoding="utf-8")
    say(f"wrote {output / 'plan.json'} and {output / 'table.md'}")
