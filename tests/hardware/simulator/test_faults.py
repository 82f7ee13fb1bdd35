import re
from pathlib import Path

import pytest

from hardware.bus.packets import ERROR_OVERHEATING, ERROR_OVERLOAD, ERROR_VOLTAGE, PING
from hardware.simulator.faults import FAULTS, FaultRefused, apply_fault
from tests.hardware.simulator.conftest import Answer, Client, HandClock

DOCUMENT = Path(__file__).parents[3] / "docs" / "simulated_bus.md"
OK = Answer(11, 0, b"")


def do(client: Client, *lines: str) -> None:
    for line in lines:
        apply_fault(client.bus, line)


def start(client: Client, goal: int = 900) -> None:
    assert client.write(11, "moving_speed", 30) == 0
    assert client.write(11, "goal_position", goal) == 0


def position(client: Client) -> float:
    servo = client.bus.servo(11)
    assert servo is not None
    return servo.position


def test_missing(arm_client: Client) -> None:
    do(arm_client, "missing 11")
    assert arm_client.ask(11, PING) == []
    assert arm_client.ask(21, PING) == [Answer(21, 0, b"")]
    do(arm_client, "heal")
    assert arm_client.ask(11, PING) == [OK]


@pytest.mark.parametrize(
    ("fault", "bit"), [("overload 11", ERROR_OVERLOAD), ("overheat 11", ERROR_OVERHEATING)]
)
def test_shutdown(arm_client: Client, clock: HandClock, fault: str, bit: int) -> None:
    start(arm_client)
    clock.pass_s(0.5)
    do(arm_client, fault)
    stopped = position(arm_client)
    clock.pass_s(10)
    assert position(arm_client) == stopped != 900
    assert arm_client.ask(11, PING) == [Answer(11, bit, b"")]
    assert arm_client.ask(21, PING) == [Answer(21, 0, b"")]
    assert arm_client.read(11, "torque_limit") == 0
    do(arm_client, "heal")
    assert arm_client.ask(11, PING) == [OK]
    assert arm_client.read(11, "torque_limit") == 0
    clock.pass_s(10)
    assert position(arm_client) == stopped
    arm_client.write(11, "torque_limit", 1023)
    clock.pass_s(60)
    assert position(arm_client) == 900


def test_shutdown_only_on_what_the_register_says(arm_client: Client) -> None:
    arm_client.write(11, "shutdown", ERROR_OVERHEATING)
    do(arm_client, "overload 11")
    assert arm_client.ask(11, PING) == [Answer(11, ERROR_OVERLOAD, b"")]
    assert arm_client.read(11, "torque_limit") == 1023


def test_voltage_is_an_error_without_a_shutdown(arm_client: Client, clock: HandClock) -> None:
    do(arm_client, "voltage 11")
    assert arm_client.read(11, "present_voltage") == 59
    assert arm_client.ask(11, PING) == [Answer(11, ERROR_VOLTAGE, b"")]
    assert arm_client.read(11, "torque_limit") == 1023
    do(arm_client, "heal")
    assert arm_client.ask(11, PING) == [OK]


def test_jam(arm_client: Client, clock: HandClock) -> None:
    start(arm_client)
    begun = position(arm_client)
    clock.pass_s(0.5)
    do(arm_client, "jam 11")
    stopped = position(arm_client)
    assert begun < stopped < 900
    clock.pass_s(10)
    assert position(arm_client) == stopped
    assert arm_client.ask(11, PING) == [OK]
    assert arm_client.read(11, "present_speed") in (0, 1024)
    assert arm_client.read(11, "present_load") == 1023
    assert arm_client.read(11, "moving") == 1
    clock.pass_s(10)
    do(arm_client, "heal")
    assert position(arm_client) == stopped
    clock.pass_s(60)
    assert position(arm_client) == 900


def test_slip(arm_client: Client) -> None:
    before = arm_client.read(11, "present_position"), position(arm_client)
    do(arm_client, "slip 11 -40")
    assert arm_client.read(11, "present_position") == before[0] - 40
    assert position(arm_client) == before[1]
    do(arm_client, "slip 11 4095")
    assert arm_client.read(11, "present_position") == 1023
    do(arm_client, "heal")
    assert arm_client.read(11, "present_position") == before[0]


def test_return_level(arm_client: Client) -> None:
    do(arm_client, "return-level 11 0")
    assert arm_client.ask(11, PING) == [OK]
    assert arm_client.ask(11, 2, bytes((36, 2))) == []
    do(arm_client, "heal")
    assert arm_client.read(11, "status_return_level") == 2


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_corrupt(arm_client: Client, share: float) -> None:
    do(arm_client, f"corrupt {share}")
    heard = [arm_client.ask(11, PING)[0].checksum_valid for _ in range(400)]
    assert heard.count(False) == pytest.approx(400 * share, abs=40 if 0 < share < 1 else 0)
    do(arm_client, "heal")
    assert all(arm_client.ask(11, PING)[0].checksum_valid for _ in range(50))


def test_corrupt_next(arm_client: Client) -> None:
    do(arm_client, "corrupt-next 3")
    heard = [arm_client.ask(11, PING)[0].checksum_valid for _ in range(6)]
    assert heard == [False] * 3 + [True] * 3


def test_silent(arm_client: Client) -> None:
    do(arm_client, "silent")
    assert [arm_client.ask(servo.servo_id, PING) for servo in arm_client.bus.servos] == [[]] * 8
    arm_client.ask(254, 3, bytes((25, 1)))
    do(arm_client, "heal")
    assert arm_client.read(11, "led") == 0


def test_power_cycle(arm_client: Client, clock: HandClock) -> None:
    start(arm_client)
    clock.pass_s(0.5)
    do(arm_client, "overload 11", "overheat 21", "power-cycle")
    stopped = position(arm_client)
    assert arm_client.ask(11, PING) == [OK]
    assert arm_client.read(11, "torque_enable") == 0
    assert arm_client.read(11, "torque_limit") == 1023
    # Heat does not go away by switching off and on.
    assert arm_client.ask(21, PING) == [Answer(21, ERROR_OVERHEATING, b"")]
    assert arm_client.read(21, "torque_limit") == 0
    clock.pass_s(10)
    assert position(arm_client) == stopped
    do(arm_client, "heal", "power-cycle")
    assert arm_client.read(21, "torque_limit") == 1023


def test_unplug(arm_client: Client) -> None:
    assert not arm_client.bus.unplugged
    do(arm_client, "unplug")
    assert arm_client.bus.unplugged


@pytest.mark.parametrize("line", ["", "   ", "\t\r"])
def test_empty_lines_say_nothing(arm_client: Client, line: str) -> None:
    do(arm_client, line)
    assert arm_client.ask(11, PING) == [OK]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("explode", f"no fault 'explode'; known: {', '.join(FAULTS)}"),
        ("Missing 11", "no fault 'Missing'"),
        ("missing", "usage: missing ID"),
        ("missing 11 21", "usage: missing ID"),
        ("heal 11", "usage: heal"),
        ("missing 12", "no servo '12'; known: 11, 21, 22, 31, 32, 41, 51, 61"),
        ("jam eleven", "no servo 'eleven'"),
        ("corrupt 2", "SHARE is a number from 0 to 1"),
        ("corrupt nan", "SHARE is a number from 0 to 1"),
        ("corrupt lots", "SHARE is a number from 0 to 1"),
        ("corrupt-next -1", "COUNT is a whole number from 0"),
        ("slip 11 far", "TICKS is a whole number from -4095"),
        ("return-level 11 3", "LEVEL is a whole number from 0 to 2"),
    ],
)
def test_commands_that_are_refused(arm_client: Client, line: str, message: str) -> None:
    with pytest.raises(FaultRefused) as refused:
        do(arm_client, line)
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_the_document_has_the_table_of_the_code() -> None:
    rows = re.findall(r"^\| `(.+?)` \| (.+?) \|$", DOCUMENT.read_text(encoding="utf-8"), re.M)
    assert rows == [
        (" ".join((name, *command.arguments)), command.help) for name, command in FAULTS.items()
    ]
