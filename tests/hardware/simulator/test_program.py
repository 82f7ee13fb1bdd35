"""The real program as a process of its own, spoken to with the vendor's library."""

import contextlib
import os
import re
import shlex
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from dynamixel_sdk import COMM_SUCCESS
from typer.testing import CliRunner

from app.commands.cli import cli
from hardware.servos.control_tables import SIMULATED_FIRMWARE
from hardware.servos.joints import load_arm
from solver import Robot
from tests.hardware.simulator.program import (
    COMMAND,
    PATIENCE_S,
    REPOSITORY,
    TRIES,
    Port,
    Process,
    Start,
    finish,
)

MODELS = {11: 64, 21: 107, 22: 107, 31: 64, 32: 64, 41: 64, 51: 64, 61: 28}


@pytest.fixture
def start() -> Iterator[Start]:
    """Starts the program, waits for its device, and leaves nothing running."""
    with contextlib.ExitStack() as ended:

        def begin(*options: str, stdin: int = subprocess.PIPE) -> tuple[Process, str]:
            process = subprocess.Popen(
                [*COMMAND, *options],
                cwd=REPOSITORY,
                stdin=stdin,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            )
            ended.enter_context(process)
            ended.callback(process.kill)
            assert process.stdout is not None
            return process, process.stdout.readline().rstrip("\n")

        yield begin


def test_the_vendors_library_reads_every_servo(start: Start, tabletop: Robot) -> None:
    process, device = start("--noise-ticks", "0")
    with contextlib.closing(Port(device)) as port:
        assert {servo_id: port.ping(servo_id) for servo_id in MODELS} == MODELS
        found = {}
        for servo_id in MODELS:
            assert port.read(servo_id, 2, 1)[0] == SIMULATED_FIRMWARE
            state = port.read(servo_id, 36, 8)
            found[servo_id] = int.from_bytes(state[:2], "little")
            assert state[6] == 160
    assert found == load_arm(tabletop, "tabletop").goals(tabletop.home_joints)
    out, err = finish(process, "unplug\n")
    assert out == ""
    assert len(err.splitlines()) == 1


def test_a_second_client_may_come_after_the_first(start: Start) -> None:
    process, device = start()
    for _ in range(2):
        with contextlib.closing(Port(device)) as port:
            assert port.ping(11) == 64
    finish(process, "unplug\n")


def test_it_turns_faster_than_the_wall_clock_when_told_so(start: Start) -> None:
    process, device = start("--time-factor", "100000", "--noise-ticks", "0")
    with contextlib.closing(Port(device)) as port:
        assert port.packets.write4ByteTxRx(port.handler, 11, 30, 700 | 1 << 16) == (0, 0)
        for _ in range(TRIES):
            if port.read(11, 46, 1) == b"\x00":
                break
        assert port.read(11, 36, 2) == (700).to_bytes(2, "little")
    finish(process, "unplug\n")


def test_starts_where_it_is_told_to_with_a_calibration(
    start: Start, tabletop: Robot, tmp_path: Path
) -> None:
    calibration = REPOSITORY / "hardware" / "servos" / "calibrations" / "tabletop_thesis.toml"
    process, device = start(
        "--robot=tabletop-sim",
        "--joints-deg=10,20,-30,40,50,-60",
        f"--calibration={calibration}",
        "--noise-ticks=0",
    )
    with contextlib.closing(Port(device)) as port:
        assert port.read(11, 36, 2) == round((150 + 10 + 1) * 1023 / 300).to_bytes(2, "little")
        assert port.read(61, 36, 2) == round((150 - 60) * 1023 / 300).to_bytes(2, "little")
    finish(process, "unplug\n")


def test_faults_from_the_command_line_and_from_standard_input(start: Start) -> None:
    process, device = start("--fault", "missing 11", "--fault", "missing 21")
    with contextlib.closing(Port(device)) as port:
        assert port.ping(61) == 28
        for servo_id in (11, 21):
            assert port.packets.ping(port.handler, servo_id)[1] != COMM_SUCCESS
        assert process.stdin is not None
        process.stdin.write("heal\nexplode\n")
        process.stdin.flush()
        assert port.ping(11) == 64
    _, err = finish(process, "unplug\n")
    assert [line for line in err.splitlines() if line.startswith("no fault 'explode'; known: ")]


def test_the_last_line_of_commands_needs_no_end(start: Start) -> None:
    process, device = start()
    finish(process, "unplug")
    assert not os.path.exists(device)


@pytest.mark.parametrize("closed", [False, True])
def test_the_bus_goes_on_without_standard_input(closed: bool) -> None:
    command = [*COMMAND, "--noise-ticks", "0"]
    if closed:
        command = ["sh", "-c", 'exec "$@" <&-', "sh", *command]
    with subprocess.Popen(
        command,
        cwd=REPOSITORY,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            device = process.stdout.readline().rstrip("\n")
            with contextlib.closing(Port(device)) as port:
                assert port.ping(11) == 64
            process.terminate()
            finish(process)
        finally:
            process.kill()


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it(start: Start, tmp_path: Path, kind: signal.Signals) -> None:
    link = tmp_path / "bus"
    process, device = start("--link", str(link))
    assert os.readlink(link) == device
    with contextlib.closing(Port(str(link))) as port:
        assert port.ping(11) == 64
    process.send_signal(kind)
    finish(process)
    assert not link.is_symlink()


def test_a_signal_ends_it_even_if_nobody_fetches_the_answers(start: Start) -> None:
    process, device = start()
    client = os.open(device, os.O_RDWR | os.O_NOCTTY)
    try:
        os.write(client, bytes.fromhex("FF FF 0B 04 02 00 32 BC") * 500)
        process.terminate()
        finish(process)
        assert process.returncode == 0
    finally:
        os.close(client)


def test_a_client_sees_that_the_device_is_gone(start: Start) -> None:
    process, device = start()
    client = os.open(device, os.O_RDWR | os.O_NOCTTY)
    try:
        finish(process, "unplug\n")
        try:
            data = os.read(client, 1)
        except OSError:
            data = b""
        assert data == b""
        with pytest.raises(OSError, match="Input/output"):
            os.write(client, b"\xff")
    finally:
        os.close(client)


def test_a_stale_link_is_replaced(start: Start, tmp_path: Path) -> None:
    link = tmp_path / "bus"
    link.symlink_to(tmp_path / "gone")
    process, device = start("--link", str(link))
    assert os.readlink(link) == device
    finish(process, "unplug\n")
    assert not link.is_symlink()


def test_a_link_that_became_somebody_elses_is_left(start: Start, tmp_path: Path) -> None:
    link = tmp_path / "bus"
    process, _ = start("--link", str(link))
    link.unlink()
    link.write_text("mine")
    finish(process, "unplug\n")
    assert link.read_text() == "mine"


def refused(*options: str) -> str:
    """The one line with which the program refuses."""
    finished = subprocess.run(
        [*COMMAND, *options],
        cwd=REPOSITORY,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert finished.returncode == 2
    assert finished.stdout == ""
    (line,) = finished.stderr.splitlines()
    return line


@pytest.mark.parametrize("kind", ["file", "live link"])
def test_what_stands_at_the_links_place_is_left(tmp_path: Path, kind: str) -> None:
    link, target = tmp_path / "bus", tmp_path / "target"
    target.write_text("precious")
    if kind == "file":
        link.write_text("precious")
    else:
        link.symlink_to(target)
    assert refused("--link", str(link)) == f"{link}: File exists"
    assert link.read_text() == "precious"


def test_a_link_in_a_folder_that_is_not_there() -> None:
    assert refused("--link", "/nowhere/bus") == "/nowhere/bus: No such file or directory"


@pytest.mark.parametrize(
    ("option", "line"),
    [
        ("--robot=nowhere", "unknown robot 'nowhere'; known: "),
        ("--noise-ticks=-1", "--noise-ticks is between"),
        ("--time-factor=0", "--time-factor is between"),
        ("--time-factor=inf", "--time-factor is between"),
        ("--time-factor=nan", "--time-factor is between"),
        ("--joints-deg=1,2,3", "--joints-deg is 6 numbers"),
        ("--joints-deg=1,2,3,4,5,x", "--joints-deg is 6 numbers"),
        ("--joints-deg=0,0,0,0,0,nan", "--joints-deg is 6 numbers"),
        ("--joints-deg=0,0,0,0,0,200", "joint_6: its servo cannot stand at 3.4907 rad"),
        ("--calibration=/nowhere", "/nowhere: No such file"),
        ("--fault=explode", "no fault 'explode'; known: "),
        ("--fault=missing 12", "no servo '12'; known: "),
    ],
)
def test_bad_options(option: str, line: str) -> None:
    result = CliRunner().invoke(cli, ["servo-bus", option])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith(line)
    assert len(result.stderr.splitlines()) == 1


def test_the_command_line_of_the_document(start: Start, tmp_path: Path) -> None:
    text = (REPOSITORY / "docs" / "simulated_bus.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"```sh\n(.*?)\n```", text)
    command, name, *options = shlex.split(line)
    assert (command, name) == (".venv/bin/prunus", "servo-bus")
    options = [option.replace("/tmp", str(tmp_path)) for option in options]
    process, device = start(*options)
    assert os.readlink(tmp_path / "prunus-bus") == device
    finish(process, "unplug\n")
