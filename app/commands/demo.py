"""The demonstration: service, simulated servos and worker as processes of their own.

Data set 3 is planned over HTTP, executed on the simulated servos, measured over their bus, and
drawn.
"""

import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx2
import orjson
from rich.console import Console

from app.commands.plan_table import markdown_table, print_plan
from app.schemas.demo_request import demo_request
from app.server.processes import READY_LINE, OwnProcess, ProcessFailed, own_process

START_TIMEOUT_S = 600.0  # the first start compiles every kernel
EXECUTION_TIMEOUT_S = 180.0
POLL_S = 0.1
SIMULATED_ROBOT = "tabletop-sim"
# Not where the plan starts, so that the slow way there is seen as well.
SERVOS_STAND_DEG = "12,80,-75,10,75,-15"
MOST_ERROR_M = 0.003

Say = Callable[[str], None]


class DemoFailed(Exception):
    """The demonstration cannot go on, and why."""


def run_demo(output: Path) -> int:
    """Run it; pictures, plan, account and table go to `output`.

    0 only if all five targets are planned, executed, and reached within MOST_ERROR_M.
    """
    console, started = Console(), time.monotonic()

    def say(text: str) -> None:
        elapsed = time.monotonic() - started
        console.print(f"[{elapsed:5.1f} s] {text}", highlight=False, markup=False, soft_wrap=True)

    try:
        output.mkdir(parents=True, exist_ok=True)
        plan, execution = _plan_and_execute(output / "data", say)
        print_plan(plan, console, execution)
        _write(output, plan, execution, say)
    except (DemoFailed, ProcessFailed, OSError, httpx2.HTTPError) as error:
        say(f"the demonstration failed: {error}")
        return 1
    wanted, planned = len(demo_request()["targets"]), int(plan["summary"]["planned"])
    reached = sum(map(is_reached, execution["targets"]))
    say(f"{planned} of {wanted} targets planned and verified")
    say(
        f"execution {execution['status']}; {reached} of {wanted} targets reached within "
        f"{MOST_ERROR_M * 1000:g} mm, standby and target, on simulated servos"
    )
    return 0 if planned == reached == wanted and execution["status"] == "completed" else 1


def _plan_and_execute(data: Path, say: Say) -> tuple[dict[str, Any], dict[str, Any]]:
    with ExitStack() as running:
        say("starting the service")
        service = running.enter_context(
            own_process("serve", "--port", "0", "--data-dir", str(data))
        )
        line = service.first_line(START_TIMEOUT_S)
        if not line.startswith(READY_LINE):
            raise DemoFailed(f"the service said {line!r}")
        url = line.removeprefix(READY_LINE)
        client = running.enter_context(httpx2.Client(base_url=url, timeout=START_TIMEOUT_S))
        say(f"it listens on {url}; waiting for its solver processes (the first start compiles)")
        _wait_until(lambda: client.get("/readyz").status_code == 200, "the service to be ready")
        plan = _plan(client, say)

        say("starting the simulated servo bus")
        bus = running.enter_context(own_process("servo-bus", "--joints-deg", SERVOS_STAND_DEG))
        device = bus.first_line(START_TIMEOUT_S)
        say(f"eight servos answer on {device}; starting the worker")
        worker = running.enter_context(
            own_process(
                "worker",
                *("--url", url),
                *("--robot", SIMULATED_ROBOT),
                *("--port", device),
                *("--end-effector", "simulated"),
                *("--end-effector-record", str(data / "end_effector.txt")),
                *("--data-dir", str(data)),
            )
        )
        _wait_for_worker(client, worker)
        execution = _execute(client, plan, say)
    say("service, servo bus and worker stopped")
    return plan, execution


def _plan(client: httpx2.Client, say: Say) -> dict[str, Any]:
    request = demo_request()
    say(f"posting {len(request['targets'])} targets to {client.base_url}/v1/plans")
    location = _location(client.post("/v1/plans", json=request), 201)
    say(f"201, kept as {location}; reading it back")
    plan: dict[str, Any] = client.get(location).raise_for_status().json()
    return plan


def _wait_for_worker(client: httpx2.Client, worker: OwnProcess) -> None:
    def joined() -> bool:
        if not worker.is_alive:
            raise DemoFailed("the worker ended before it joined")
        state = client.get(f"/v1/robots/{SIMULATED_ROBOT}/state").raise_for_status().json()
        return bool(state["connected"])

    _wait_until(joined, "the worker to join")


def _execute(client: httpx2.Client, plan: dict[str, Any], say: Say) -> dict[str, Any]:
    body = {"plan_id": plan["id"], "robot": SIMULATED_ROBOT}
    location = _location(client.post("/v1/executions", json=body), 202)
    say(f"202, executing {location} on {SIMULATED_ROBOT}")
    execution: dict[str, Any] = {}
    told: set[str] = set()

    def ended() -> bool:
        nonlocal execution
        execution = client.get(location).raise_for_status().json()
        for target in execution["targets"]:
            if target["status"] == "done" and target["target_id"] not in told:
                told.add(target["target_id"])
                say(f"target {target['target_id']} done, {_measured(target)}")
        return execution["status"] in ("completed", "failed", "canceled")

    _wait_until(ended, "the execution to end", EXECUTION_TIMEOUT_S)
    if "error" in execution:
        say(f"{execution['error']['code']}: {execution['error']['detail']}")
    return execution


def _measured(target: dict[str, Any]) -> str:
    standby_mm, target_mm = target["standby_error_m"] * 1000, target["target_error_m"] * 1000
    return f"measured {standby_mm:.2f} mm from standby and {target_mm:.2f} mm from the target"


def is_reached(target: dict[str, Any]) -> bool:
    """Whether a target's account says that standby and target were measured close enough."""
    errors = (target.get("standby_error_m"), target.get("target_error_m"))
    return target["status"] == "done" and all(e is not None and e <= MOST_ERROR_M for e in errors)


def _location(answer: httpx2.Response, status: int) -> str:
    if answer.status_code != status:
        raise DemoFailed(f"{answer.request.url} answered {answer.status_code}: {answer.text}")
    return str(answer.headers["location"])


def _wait_until(
    condition: Callable[[], bool], what: str, timeout_s: float = START_TIMEOUT_S
) -> None:
    deadline = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline:
            raise DemoFailed(f"waited {timeout_s:g} s for {what}")
        time.sleep(POLL_S)


def _write(output: Path, plan: dict[str, Any], execution: dict[str, Any], say: Say) -> None:
    from app.reports.drawings.arm import draw_arm
    from app.reports.drawings.effort import draw_effort
    from app.services.plans.wire import parse_request, problem_from_wire

    problem = problem_from_wire(parse_request(orjson.dumps(demo_request())))
    say("drawing the arm and the effort")
    for name, figure in (
        ("arm.png", draw_arm(plan, problem)),
        ("effort.png", draw_effort(plan, problem)),
    ):
        figure.savefig(output / name, dpi=130)
        say(f"wrote {output / name}")
    for name, body in (("plan.json", plan), ("execution.json", execution)):
        (output / name).write_bytes(orjson.dumps(body, option=orjson.OPT_INDENT_2))
    (output / "table.md").write_text(markdown_table(plan, execution), encoding="utf-8")
    say(f"wrote plan.json, execution.json and table.md to {output}")
