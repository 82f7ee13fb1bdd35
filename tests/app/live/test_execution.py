"""The whole way: live service, the worker's program, simulated servos behind a pseudo-terminal."""

import contextlib
import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx2
import pytest

from hardware.bus.dynamixel_bus import DynamixelBus
from tests.app.conftest import (
    EXAMPLE,
    REPOSITORY,
    Server,
    assert_problem,
    running_server,
    wait_until,
)
from tests.contracts.test_bus import servo_bus

Body = dict[str, Any]
ROBOT = "tabletop-sim"
TIME_FACTOR = "4"
MOST_ERROR_M = 0.003
LONG_S = 40
PATIENT_S = 12.0
"""A dwell in robot time, three seconds of the wall's, that is not over before it is noticed."""
SERVOS = (11, 21, 22, 31, 32, 41, 51, 61)


# Robot time does not wait for a busy machine.
pytestmark = pytest.mark.alone


@dataclass
class Rig:
    """A service, a simulated bus and a worker, each a process."""

    url: str
    client: httpx2.Client
    device: str
    bus: "subprocess.Popen[str]"
    worker: "subprocess.Popen[str]"
    folder: Path

    def fault(self, command: str) -> None:
        assert self.bus.stdin is not None
        self.bus.stdin.write(f"{command}\n")
        self.bus.stdin.flush()

    def state(self) -> Body:
        state: Body = self.client.get(f"/v1/robots/{ROBOT}/state").json()
        return state

    def fault_codes(self) -> list[str]:
        return [fault["code"] for fault in self.state().get("faults", [])]

    def execute(self, plan_id: str, robot: str = ROBOT) -> str:
        answer = self.client.post("/v1/executions", json={"plan_id": plan_id, "robot": robot})
        assert answer.status_code == 202, answer.text
        return str(answer.headers["location"])

    def execution(self, location: str) -> Body:
        execution: Body = self.client.get(location).json()
        return execution

    def until(self, location: str, condition: Callable[[Body], bool]) -> Body:
        wait_until(lambda: condition(self.execution(location)), LONG_S)
        return self.execution(location)

    def until_segment(self, location: str, segment: str) -> None:
        # Some are short.
        wait_until(lambda: self.execution(location).get("segment") == segment, LONG_S, poll_s=0.02)

    def until_ended(self, location: str) -> Body:
        return self.until(
            location, lambda execution: execution["status"] in ("completed", "failed", "canceled")
        )

    def fresh_joints(self) -> list[float]:
        """The joints as read after this call; the second new reading, as the first had begun."""
        for _ in range(2):
            self._until_read_again()
        joints: list[float] = self.state()["joints"]
        return joints

    def _until_read_again(self) -> None:
        before = self.state()["joints_read_at"]
        wait_until(lambda: self.state()["joints_read_at"] != before, LONG_S)

    def laser_changes(self) -> list[str]:
        lines = (self.folder / "laser.txt").read_text().splitlines()
        return [line.split()[1] for line in lines]

    def assert_holds(self) -> None:
        """Under power and standing, as read by somebody else than the worker, which has ended."""
        with contextlib.closing(DynamixelBus(self.device)) as bus:
            for servo_id in SERVOS:
                goal, position = (
                    int.from_bytes(bus.read(servo_id, address, 2).data, "little")
                    for address in (30, 36)
                )
                assert bus.read(servo_id, 24, 1).data == b"\x01"
                assert abs(goal - position) <= 2


def start_worker(url: str, device: str, folder: Path, *arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "app", "worker", "--url", url, "--port", device]
    command += ["--data-dir", str(folder), *arguments]
    return subprocess.Popen(command, cwd=REPOSITORY, stderr=subprocess.PIPE, text=True)


@contextlib.contextmanager
def running_rig(
    url: str, client: httpx2.Client, folder: Path, *bus_arguments: str
) -> Iterator[Rig]:
    with servo_bus("--time-factor", TIME_FACTOR, *bus_arguments) as (device, bus):
        worker = start_worker(
            url,
            device,
            folder,
            *("--robot", ROBOT, "--time-factor", TIME_FACTOR),
            *("--end-effector", "simulated", "--end-effector-record", str(folder / "laser.txt")),
        )
        rig = Rig(url, client, device, bus, worker, folder)
        try:
            wait_until(lambda: "joints" in rig.state() or bool(rig.fault_codes()), LONG_S)
            yield rig
        finally:
            rig.worker.send_signal(signal.SIGCONT)
            rig.worker.terminate()
            rig.worker.communicate(timeout=30)
            # The next test's worker could not join before this one has left; if there is a service.
            with contextlib.suppress(httpx2.TransportError):
                wait_until(lambda: not rig.state()["connected"], LONG_S)


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with running_server(tmp_path_factory.mktemp("live")) as it:
        yield it


@pytest.fixture
def rig(service: Server, tmp_path: Path) -> Iterator[Rig]:
    with running_rig(service.url, service.client, tmp_path) as it:
        yield it


@pytest.fixture(scope="module")
def plan_id(service: Server) -> str:
    return make_plan(service.client)


@pytest.fixture(scope="module")
def patient_plan_id(service: Server) -> str:
    return make_plan(service.client, dwell_s=PATIENT_S)


def make_plan(client: httpx2.Client, *, dwell_s: float = 1.0, **changes: Any) -> str:
    body: Body = json.loads(EXAMPLE.read_text())
    body["options"] = {"method": "ssas", "dwell_s": dwell_s}
    answer = client.post("/v1/plans", json=body | changes)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def test_data_set_3_from_post_to_millimetres(rig: Rig, plan_id: str) -> None:
    assert rig.state()["status"] == "idle"
    assert rig.state()["torque"] == "off"
    location = rig.execute(plan_id)
    busy = rig.client.post("/v1/executions", json={"plan_id": plan_id, "robot": ROBOT})
    assert_problem(busy, 409)
    execution = rig.until_ended(location)
    assert execution["status"] == "completed", execution
    assert execution["simulated"] is True
    assert [target["status"] for target in execution["targets"]] == ["done"] * 5
    for target in execution["targets"]:
        assert 0 < target["standby_error_m"] < MOST_ERROR_M
        assert 0 < target["target_error_m"] < MOST_ERROR_M
        assert len(target["measured_standby_joints"]) == 6
        assert len(target["measured_thinning_joints"]) == 6
    assert rig.laser_changes()[:2] == ["off", "off"]
    assert rig.laser_changes()[2:] == ["on", "off"] * 5
    state = rig.state()
    assert state["torque"] == "on"
    assert state["simulated"] is True
    assert state["end_effector_state"] == "off"
    assert [servo["id"] for servo in state["servos"]] == list(SERVOS)
    assert state["joints"] == pytest.approx(
        execution["targets"][4]["measured_standby_joints"], abs=0.02
    )
    # It holds after its worker has gone, and a new worker takes over from where it stands.
    rig.worker.send_signal(signal.SIGHUP)
    assert rig.worker.wait(30) == 0
    rig.assert_holds()


def test_pause_resume_and_cancel(rig: Rig, plan_id: str) -> None:
    location = rig.execute(plan_id)
    rig.until_segment(location, "cut_in")
    assert rig.client.post(f"{location}/pause").status_code == 202
    rig.until(location, lambda execution: execution["status"] == "paused")
    assert_problem(rig.client.post(f"{location}/pause"), 409)
    stood = rig.fresh_joints()
    assert rig.fresh_joints() == pytest.approx(stood, abs=0.02)
    assert rig.client.post(f"{location}/resume").status_code == 202
    rig.until(location, lambda execution: execution["targets"][0]["status"] == "done")
    assert rig.client.post(f"{location}/pause").status_code == 202
    rig.until(location, lambda execution: execution["status"] == "paused")
    assert rig.client.post(f"{location}/cancel").status_code == 202
    # Nothing takes a cancel back.
    assert_problem(rig.client.post(f"{location}/resume"), 409)
    execution = rig.until_ended(location)
    assert execution["status"] == "canceled"
    assert rig.laser_changes()[-1] == "off"
    # Nothing was wrong, so nothing is to be acknowledged.
    assert rig.until_ended(rig.execute(plan_id))["status"] == "completed"


@pytest.mark.parametrize("segment", ["transfer", "cut_in", "dwell", "retreat"])
def test_a_stop_in_the_middle_is_verified_and_latched(rig: Rig, plan_id: str, segment: str) -> None:
    location = rig.execute(plan_id)
    rig.until_segment(location, segment)
    report = rig.client.post(f"/v1/robots/{ROBOT}/stop").json()
    assert report["stopped"] is True, report
    assert report["verified"] is True, report
    execution = rig.until_ended(location)
    assert execution["status"] == "failed"
    assert execution["error"]["code"] == "stopped"
    assert rig.laser_changes()[-1] == "off"
    assert rig.fresh_joints() == pytest.approx(report["joints"], abs=0.02)
    refused = rig.client.post("/v1/executions", json={"plan_id": plan_id, "robot": ROBOT})
    assert assert_problem(refused, 409)["type"].endswith("fault")
    assert rig.client.post(f"/v1/robots/{ROBOT}/acknowledge").json() == {"faults": []}
    assert rig.client.post(f"{rig.execute(plan_id)}/cancel").status_code == 202


@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("missing 41", "servo_missing"),
        ("corrupt 1", "corrupt_packets"),
        ("overload 31", "servo_alarm"),
        ("jam 11", "following_error"),
        ("unplug", "bus_lost"),
    ],
)
def test_trouble_on_the_bus_ends_it_with_the_cause(
    rig: Rig, patient_plan_id: str, command: str, code: str
) -> None:
    location = rig.execute(patient_plan_id)
    rig.until_segment(location, "dwell")
    rig.fault(command)
    execution = rig.until_ended(location)
    assert execution["status"] == "failed"
    assert execution["error"]["code"] == code
    assert execution["error"]["detail"]
    first, *others = execution["targets"]
    if command.startswith("jam"):
        # A jam shows when the joint is to turn again.
        assert first["status"] == "done"
    else:
        # The laser was on it, but not for as long as it should have been.
        assert first["status"] == "unknown"
        assert first["error"]["code"] == code
    assert {target["status"] for target in others} <= {"not_started", "skipped"}
    assert rig.laser_changes()[-1] == "off"
    wait_until(lambda: rig.state()["status"] == "fault", LONG_S)
    assert code in rig.fault_codes()


def test_a_killed_worker_leaves_the_arm_holding_and_the_laser_off(
    rig: Rig, plan_id: str, patient_plan_id: str, tmp_path: Path
) -> None:
    location = rig.execute(patient_plan_id)
    rig.until_segment(location, "dwell")
    rig.worker.kill()
    rig.worker.communicate()
    execution = rig.until_ended(location)
    assert execution["status"] == "failed"
    assert execution["error"]["code"] == "worker_lost"
    assert execution["targets"][0]["status"] == "unknown"
    assert execution["targets"][1]["status"] == "not_started"
    wait_until(lambda: rig.laser_changes()[-1] == "off", 5)
    rig.assert_holds()
    assert rig.state() == {
        "robot": ROBOT,
        "connected": False,
        "status": "disconnected",
        "simulated": True,
    }
    no_worker = rig.client.post("/v1/executions", json={"plan_id": plan_id, "robot": ROBOT})
    assert assert_problem(no_worker, 503)["type"].endswith("no_worker")
    assert_problem(rig.client.post(f"/v1/robots/{ROBOT}/stop"), 503)
    # The next worker wants somebody to look first.
    rig.worker = start_worker(
        rig.url, rig.device, tmp_path, "--robot", ROBOT, "--time-factor", TIME_FACTOR
    )
    wait_until(lambda: rig.fault_codes() == ["interrupted"], LONG_S)
    assert rig.client.post(f"/v1/robots/{ROBOT}/acknowledge").json() == {"faults": []}
    assert rig.until_ended(rig.execute(plan_id))["status"] == "completed"


def test_a_worker_that_hangs_is_given_up_and_does_not_go_on_later(
    rig: Rig, patient_plan_id: str
) -> None:
    location = rig.execute(patient_plan_id)
    rig.until_segment(location, "dwell")
    rig.worker.send_signal(signal.SIGSTOP)
    # Its guard is a process of its own and does not hang with it.
    wait_until(lambda: rig.laser_changes()[-1] == "off", 5)
    execution = rig.until_ended(location)
    assert execution["status"] == "failed"
    assert execution["error"]["code"] in ("link_lost", "worker_lost")
    assert execution["targets"][0]["status"] == "unknown"
    rig.worker.send_signal(signal.SIGCONT)
    # Which of the two it notices first depends on where in a tick it stood still.
    causes = {"link_lost", "end_effector_failed"}
    wait_until(lambda: bool(causes & set(rig.fault_codes())), LONG_S)
    assert rig.laser_changes()[-1] == "off"
    # What the worker knew of it is told when it is back; failed it stays.
    execution = rig.until(location, lambda execution: "error" in execution["targets"][0])
    assert execution["status"] == "failed"
    assert execution["targets"][0]["error"]["code"] in causes
    assert execution["targets"][0]["target_error_m"] < MOST_ERROR_M


def test_a_service_that_dies_leaves_the_arm_holding(tmp_path: Path) -> None:
    data, folder = tmp_path / "data", tmp_path / "worker"
    folder.mkdir()
    with (
        running_server(data) as first,
        httpx2.Client(base_url=first.url, trust_env=False) as client,
        running_rig(first.url, client, folder) as rig,
    ):
        location = rig.execute(make_plan(first.client, dwell_s=PATIENT_S))
        rig.until_segment(location, "dwell")
        first.process.kill()
        first.process.wait()
        wait_until(lambda: rig.laser_changes()[-1] == "off", 10)
        with running_server(data, port=first.url.rpartition(":")[2]):
            wait_until(lambda: "link_lost" in rig.fault_codes(), LONG_S)
            execution = rig.until(location, lambda execution: "error" in execution["targets"][0])
            assert execution["status"] == "failed"
            assert execution["error"]["code"] == "service_restarted"
            assert execution["targets"][0]["target_error_m"] < MOST_ERROR_M


def test_a_servo_that_is_missing_from_the_start_is_told_by_the_service(
    service: Server, tmp_path: Path
) -> None:
    with running_rig(service.url, service.client, tmp_path, "--fault", "missing 51") as rig:
        wait_until(lambda: rig.fault_codes() == ["servo_missing"], LONG_S)
        (fault,) = rig.state()["faults"]
        assert "51" in fault["detail"]
        rig.fault("heal")
        wait_until(
            lambda: rig.client.post(f"/v1/robots/{ROBOT}/acknowledge").json() == {"faults": []},
            LONG_S,
        )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--robot", ROBOT, "--port", "/dev/no-such-device"), "No such file"),
        (("--robot", "elsewhere"), "unknown robot"),
        (("--robot", ROBOT, "--tool", "saw"), "--tool saw"),
        (("--robot", ROBOT, "--end-effector", "flame"), "flame"),
        (("--robot", ROBOT, "--url", "ftp://127.0.0.1"), "http"),
        (("--robot", ROBOT, "--calibration", "/nowhere.toml"), "/nowhere.toml"),
        (("--robot", ROBOT, "--time-factor", "0"), "--time-factor"),
    ],
)
def test_a_worker_that_cannot_work_says_why_in_one_line(
    service: Server, tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    with servo_bus() as (device, _):
        worker = start_worker(service.url, device, tmp_path, *arguments)
        _, errors = worker.communicate(timeout=60)
    assert worker.returncode == 1
    assert said in errors
    assert len(errors.splitlines()) == 1


def test_a_port_and_a_robot_have_one_worker(rig: Rig, tmp_path: Path) -> None:
    other = start_worker(rig.url, rig.device, tmp_path, "--robot", ROBOT)
    _, errors = other.communicate(timeout=60)
    assert other.returncode == 1
    assert "another program has it" in errors
    with servo_bus() as (device, _):
        second = start_worker(rig.url, device, tmp_path / "second", "--robot", ROBOT)
        assert second.stderr is not None
        assert "has a worker already" in second.stderr.readline()
        second.terminate()
        second.communicate(timeout=30)
    assert rig.state()["device"] == rig.device


def test_a_plan_for_another_tool_is_refused(rig: Rig, service: Server) -> None:
    plan = make_plan(service.client, tool="scaffold", start_joints=[0.0] * 6)
    answer = rig.client.post("/v1/executions", json={"plan_id": plan, "robot": ROBOT})
    assert assert_problem(answer, 409)["type"].endswith("tool_mismatch")


def test_the_worker_leaves_no_process_behind(rig: Rig) -> None:
    children = _children(rig.worker.pid)
    assert children
    rig.worker.kill()
    rig.worker.communicate()
    wait_until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in children), 10)


def _children(parent: int) -> list[int]:
    listed = Path(f"/proc/{parent}/task/{parent}/children").read_text()
    return [int(pid) for pid in listed.split()]
