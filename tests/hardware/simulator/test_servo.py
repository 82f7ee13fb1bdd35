"""Golden bytes are the examples of the ROBOTIS e-manual, Protocol 1.0."""

import pytest

from hardware.bus.packets import (
    ACTION,
    BROADCAST_ID,
    BULK_READ,
    ERROR_ANGLE_LIMIT,
    ERROR_CHECKSUM,
    ERROR_INSTRUCTION,
    ERROR_OVERHEATING,
    ERROR_OVERLOAD,
    ERROR_RANGE,
    PING,
    READ,
    REG_WRITE,
    RESET,
    WRITE,
    instruction_packet,
)
from hardware.servos.control_tables import SIMULATED_FIRMWARE, servo_models
from tests.hardware.simulator.conftest import Answer, Client, MakeClient

models = pytest.mark.parametrize("model", sorted(servo_models()))


def exchange(client: Client, packet: str) -> str:
    return client.bus.respond(bytes.fromhex(packet)).hex(" ").upper()


def test_ping_of_the_emanual(make_client: MakeClient) -> None:
    assert exchange(make_client(1), "FF FF 01 02 01 FB") == "FF FF 01 02 00 FC"


def test_read_of_the_emanual(make_client: MakeClient) -> None:
    client = make_client(1)
    client.bus.servos[0].table["present_temperature"] = 32
    assert exchange(client, "FF FF 01 04 02 2B 01 CC") == "FF FF 01 03 00 20 DB"


def test_write_of_the_emanual_gives_an_id_and_nobody_answers(make_client: MakeClient) -> None:
    client = make_client(7)
    assert exchange(client, "FF FF FE 04 03 03 01 F6") == ""
    assert client.bus.servo(7) is None
    assert client.read(1, "id") == 1


def test_reg_write_and_action_of_the_emanual(make_client: MakeClient) -> None:
    client = make_client(1)
    assert exchange(client, "FF FF 01 05 04 1E F4 01 E2") == "FF FF 01 02 00 FC"
    assert client.read(1, "registered_instruction") == 1
    assert client.read(1, "goal_position") == 512
    assert exchange(client, "FF FF FE 02 05 FA") == ""
    assert client.read(1, "registered_instruction") == 0
    assert client.read(1, "goal_position") == 500


def test_reset_of_the_emanual(make_client: MakeClient) -> None:
    client = make_client(0)
    client.write(0, "temperature_limit", 70)
    client.write(0, "torque_enable", 1)
    assert exchange(client, "FF FF 00 02 06 F7") == "FF FF 00 02 00 FD"
    assert client.read(0, "temperature_limit") == 80
    assert client.read(0, "torque_enable") == 0
    assert client.read(0, "baud_rate") == 1


def test_sync_write_of_the_emanual(make_client: MakeClient) -> None:
    client = make_client(0, 1, 2)
    packet = "FF FF FE 0E 83 1E 04 00 10 00 50 01 01 20 02 60 03 67"
    assert exchange(client, packet) == ""
    goals = [client.read(servo_id, "goal_position") for servo_id in range(3)]
    speeds = [client.read(servo_id, "moving_speed") for servo_id in range(3)]
    assert goals == [0x010, 0x220, 512]
    assert speeds == [0x150, 0x360, 0]


def test_error_example_of_the_emanual_is_overload_and_overheating(make_client: MakeClient) -> None:
    client = make_client(1)
    client.bus.servos[0].faults.overloaded = True
    client.bus.servos[0].table["present_temperature"] = 81
    assert exchange(client, "FF FF 01 02 01 FB") == "FF FF 01 02 24 D8"


@models
def test_the_whole_table_can_be_read_and_no_more(make_client: MakeClient, model: str) -> None:
    client = make_client(1, model=model)
    kind = servo_models()[model]
    size = max(register.address + register.size for register in kind.registers.values())
    assert size == (58 if model == "EX-106+" else 50)
    (answer,) = client.ask(1, READ, bytes((0, size)))
    assert answer.error == 0
    changed = {
        "model_number": kind.model_number,
        "firmware_version": SIMULATED_FIRMWARE,
        "baud_rate": 1,
        "goal_position": 512,
        "present_position": 512,
        "torque_limit": 1023,
        "present_voltage": 160,
        "present_temperature": 35,
        "sensed_current": 512,
    }
    for name, register in kind.registers.items():
        data = answer.parameters[register.address : register.address + register.size]
        expected = changed.get(name, kind.defaults.get(name, 0))
        assert int.from_bytes(data, "little") == expected, name
    assert client.ask(1, READ, bytes((0, size + 1))) == [Answer(1, ERROR_RANGE, b"")]
    assert client.ask(1, READ, bytes((0, 0))) == [Answer(1, ERROR_RANGE, b"")]


def test_several_registers_in_one_write(make_client: MakeClient) -> None:
    client = make_client(1)
    assert client.ask(1, WRITE, bytes((30, 0xF4, 1, 100, 0))) == [Answer(1, 0, b"")]
    assert client.read(1, "goal_position") == 500
    assert client.read(1, "moving_speed") == 100


def test_half_a_register_is_written_as_the_value_it_makes(make_client: MakeClient) -> None:
    client = make_client(1, position=0x1F4)
    assert client.ask(1, WRITE, bytes((31, 2))) == [Answer(1, 0, b"")]
    assert client.read(1, "goal_position") == 0x2F4
    assert client.ask(1, WRITE, bytes((31, 4))) == [Answer(1, ERROR_RANGE, b"")]
    assert client.read(1, "goal_position") == 0x2F4


@pytest.mark.parametrize(
    "data",
    [
        bytes((36, 1, 0)),  # read-only
        bytes((0, 1, 1)),
        bytes((34, 0, 0, 1, 0)),  # into a read-only one
        bytes((30, 0xF4, 1, 0, 4)),  # a good goal, a speed of 1024
        bytes((24, 2)),
        bytes((16, 3)),
        bytes((3, 253)),
        bytes((19, 1)),  # reserved
        bytes((48, 0, 0, 0)),  # past the end
        bytes((200, 1)),
        bytes((30,)),  # nothing
    ],
)
def test_a_refused_write_writes_nothing(make_client: MakeClient, data: bytes) -> None:
    client = make_client(1)
    before = client.ask(1, READ, bytes((0, 50)))
    for instruction in (WRITE, REG_WRITE):
        assert client.ask(1, instruction, data) == [Answer(1, ERROR_RANGE, b"")]
    assert client.ask(1, READ, bytes((0, 50))) == before


def test_goals_outside_the_angle_limits_are_not_taken(make_client: MakeClient) -> None:
    client = make_client(1)
    client.write(1, "cw_angle_limit", 100)
    client.write(1, "ccw_angle_limit", 900)
    assert client.write(1, "goal_position", 100) == 0
    assert client.write(1, "goal_position", 99) == ERROR_ANGLE_LIMIT
    assert client.write(1, "goal_position", 901) == ERROR_ANGLE_LIMIT
    assert client.read(1, "goal_position") == 100
    assert client.read(1, "torque_limit") == 1023


def test_the_shutdown_register_says_which_errors_shut_down(make_client: MakeClient) -> None:
    client = make_client(1)
    client.write(1, "ccw_angle_limit", 900)
    client.write(1, "shutdown", ERROR_ANGLE_LIMIT)
    assert client.write(1, "goal_position", 901) == ERROR_ANGLE_LIMIT
    assert client.read(1, "torque_limit") == 0


def test_a_limit_below_the_temperature_is_overheating(make_client: MakeClient) -> None:
    client = make_client(1)
    assert client.write(1, "temperature_limit", 34) == ERROR_OVERHEATING
    assert client.read(1, "torque_limit") == 0


def test_lock_leaves_24_to_35_writable_until_power_off(make_client: MakeClient) -> None:
    client = make_client(1)
    assert client.write(1, "lock", 1) == 0
    for name in ("id", "shutdown", "punch", "lock"):
        assert client.write(1, name, 0) == ERROR_RANGE, name
    for name in ("torque_enable", "goal_position", "torque_limit"):
        assert client.write(1, name, 1) == 0, name
    client.bus.servos[0].power_cycle()
    assert client.write(1, "punch", 0) == 0


@pytest.mark.parametrize("instruction", [BULK_READ, 0x07, 0x00, 0xFF])
def test_unknown_instructions(make_client: MakeClient, instruction: int) -> None:
    answer = Answer(1, ERROR_INSTRUCTION, b"")
    assert make_client(1).ask(1, instruction, bytes((0, 2, 1, 30))) == [answer]


@pytest.mark.parametrize(
    ("instruction", "parameters"), [(READ, b""), (READ, b"\x00"), (WRITE, b""), (REG_WRITE, b"")]
)
def test_instructions_without_their_parameters(
    make_client: MakeClient, instruction: int, parameters: bytes
) -> None:
    answer = Answer(1, ERROR_INSTRUCTION, b"")
    assert make_client(1).ask(1, instruction, parameters) == [answer]


def test_action_with_nothing_registered(make_client: MakeClient) -> None:
    assert make_client(1).ask(1, ACTION) == [Answer(1, ERROR_INSTRUCTION, b"")]


@pytest.mark.parametrize("instruction", [PING, READ, WRITE, REG_WRITE, ACTION, RESET, BULK_READ])
def test_nobody_answers_a_broadcast(make_client: MakeClient, instruction: int) -> None:
    assert make_client(1, 2).ask(BROADCAST_ID, instruction, bytes((25, 1))) == []


@pytest.mark.parametrize(("level", "answered"), [(2, (1, 1, 1)), (1, (1, 1, 0)), (0, (1, 0, 0))])
def test_status_return_level(
    make_client: MakeClient, level: int, answered: tuple[int, int, int]
) -> None:
    client = make_client(1)
    # The answer to the change itself is still as before.
    assert client.ask(1, WRITE, bytes((16, level))) == [Answer(1, 0, b"")]
    counts = (
        len(client.ask(1, PING)),
        len(client.ask(1, READ, bytes((36, 2)))),
        len(client.ask(1, WRITE, bytes((25, 1)))),
    )
    assert counts == answered
    assert client.bus.servos[0].table["led"] == 1


@pytest.mark.parametrize("level", [2, 1])
def test_a_wrong_checksum_writes_nothing(make_client: MakeClient, level: int) -> None:
    client = make_client(1)
    client.bus.servos[0].table["status_return_level"] = level
    packet = bytearray(instruction_packet(1, WRITE, bytes((25, 1))))
    packet[-1] ^= 1
    answer = instruction_packet(1, ERROR_CHECKSUM) if level == 2 else b""
    assert client.bus.respond(bytes(packet)) == answer
    assert client.read(1, "led") == 0
    broken_read = instruction_packet(1, READ, bytes((36, 2)))[:-1] + b"\x00"
    assert client.bus.respond(broken_read) == answer


def test_a_standing_error_is_in_every_answer(make_client: MakeClient) -> None:
    client = make_client(1)
    client.bus.servos[0].faults.overloaded = True
    client.bus.servos[0].protect()
    (ping,), (read,) = client.ask(1, PING), client.ask(1, READ, bytes((34, 2)))
    assert ping.error == read.error == ERROR_OVERLOAD
    assert read.parameters == bytes(2)
    assert client.write(1, "torque_limit", 500) == ERROR_OVERLOAD
    assert client.read(1, "torque_limit") == 0
