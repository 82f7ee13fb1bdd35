"""Golden bytes are the examples of the ROBOTIS e-manual, Protocol 1.0."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hardware.bus.packets import (
    ACTION,
    BROADCAST_ID,
    ERROR_NAMES,
    PING,
    READ,
    REG_WRITE,
    RESET,
    SYNC_WRITE,
    WRITE,
    InstructionPacket,
    PacketReader,
    checksum,
    error_names,
    instruction_packet,
    status_packet,
)

EMANUAL_INSTRUCTIONS = [
    ("FF FF 01 05 03 0C 64 AA DC", 1, WRITE, "0C 64 AA"),
    ("FF FF 01 02 01 FB", 1, PING, ""),
    ("FF FF 01 04 02 2B 01 CC", 1, READ, "2B 01"),
    ("FF FF FE 04 03 03 01 F6", BROADCAST_ID, WRITE, "03 01"),
    ("FF FF 01 05 04 1E F4 01 E2", 1, REG_WRITE, "1E F4 01"),
    ("FF FF FE 02 05 FA", BROADCAST_ID, ACTION, ""),
    ("FF FF 00 02 06 F7", 0, RESET, ""),
    (
        "FF FF FE 0E 83 1E 04 00 10 00 50 01 01 20 02 60 03 67",
        BROADCAST_ID,
        SYNC_WRITE,
        "1E 04 00 10 00 50 01 01 20 02 60 03",
    ),
]
EMANUAL_ANSWERS = [
    ("FF FF 01 02 00 FC", 1, 0, ""),
    ("FF FF 01 03 00 20 DB", 1, 0, "20"),
    ("FF FF 00 02 00 FD", 0, 0, ""),
    ("FF FF 01 02 24 D8", 1, 0x24, ""),
]

packets = st.builds(
    InstructionPacket, st.integers(0, 254), st.integers(0, 255), st.binary(max_size=40)
)
# No FF: such a byte may be taken for the beginning of a header, and then only resending helps.
garbage = st.binary(max_size=10).map(lambda data: data.replace(b"\xff", b"\xfe"))


def encoded(packet: InstructionPacket) -> bytes:
    return instruction_packet(packet.servo_id, packet.instruction, packet.parameters)


def read_in_chunks(stream: bytes, cuts: list[int]) -> list[InstructionPacket]:
    places = [0, *sorted(cut % (len(stream) + 1) for cut in cuts), len(stream)]
    reader = PacketReader()
    chunks = [stream[a:b] for a, b in pairwise(places)]
    return [packet for chunk in chunks for packet in reader.feed(chunk)]


def test_checksum_of_the_emanual() -> None:
    assert checksum(bytes.fromhex("01 05 03 0C 64 AA")) == 0xDC


@pytest.mark.parametrize(("packet", "servo_id", "code", "parameters"), EMANUAL_INSTRUCTIONS)
def test_instructions_of_the_emanual(
    packet: str, servo_id: int, code: int, parameters: str
) -> None:
    data = bytes.fromhex(packet)
    assert instruction_packet(servo_id, code, bytes.fromhex(parameters)) == data
    expected = InstructionPacket(servo_id, code, bytes.fromhex(parameters))
    assert list(PacketReader().feed(data)) == [expected]


@pytest.mark.parametrize(("packet", "servo_id", "error", "parameters"), EMANUAL_ANSWERS)
def test_answers_of_the_emanual(packet: str, servo_id: int, error: int, parameters: str) -> None:
    assert status_packet(servo_id, error, bytes.fromhex(parameters)) == bytes.fromhex(packet)


def test_the_error_of_the_emanual_is_overheating_and_overload() -> None:
    assert error_names(0x24) == ("overheating", "overload")


def test_no_error_bit_goes_unseen() -> None:
    assert error_names(0) == ()
    assert error_names(0xFF) == ERROR_NAMES
    assert [error_names(1 << bit) for bit in range(8)] == [(name,) for name in ERROR_NAMES]
    for error in range(256):
        assert len(error_names(error)) == error.bit_count()


@given(st.lists(packets, max_size=5), st.lists(st.integers(0, 10_000), max_size=8))
def test_the_stream_may_be_cut_anywhere(sent: list[InstructionPacket], cuts: list[int]) -> None:
    stream = b"".join(map(encoded, sent))
    assert read_in_chunks(stream, cuts) == sent


@given(st.binary(max_size=120), st.lists(st.integers(0, 10_000), max_size=8))
def test_any_bytes_read_the_same_however_they_are_cut(stream: bytes, cuts: list[int]) -> None:
    assert read_in_chunks(stream, cuts) == read_in_chunks(stream, [])


@given(st.lists(st.tuples(garbage, packets), min_size=1, max_size=5), garbage)
def test_garbage_between_packets_is_skipped(
    sent: list[tuple[bytes, InstructionPacket]], rest: bytes
) -> None:
    stream = b"".join(noise + encoded(packet) for noise, packet in sent) + rest
    assert read_in_chunks(stream, []) == [packet for _, packet in sent]


@given(packets)
def test_a_third_header_byte_is_no_id(packet: InstructionPacket) -> None:
    assert list(PacketReader().feed(b"\xff" + encoded(packet))) == [packet]


def test_a_wrong_checksum_is_reported_and_the_next_packet_found() -> None:
    broken = bytearray(instruction_packet(1, WRITE, b"\x19\x01"))
    broken[-1] ^= 1
    good = InstructionPacket(2, PING, b"")
    assert list(PacketReader().feed(bytes(broken) + encoded(good))) == [
        InstructionPacket(1, WRITE, b"\x19\x01", checksum_valid=False),
        good,
    ]


def test_a_packet_that_broke_off_does_not_take_the_next_ones_along() -> None:
    begun = instruction_packet(1, WRITE, bytes(8))[:7]
    good = [InstructionPacket(servo_id, PING, b"") for servo_id in range(4)]
    read = list(PacketReader().feed(begun + b"".join(map(encoded, good))))
    assert not read[0].checksum_valid
    assert [packet for packet in read if packet.checksum_valid] == good


@pytest.mark.parametrize("servo_id", [-1, 255])
def test_ids_that_do_not_exist(servo_id: int) -> None:
    with pytest.raises(ValueError, match="is not an id"):
        instruction_packet(servo_id, PING)


def test_nobody_answers_a_broadcast() -> None:
    with pytest.raises(ValueError, match="is not a servo's id"):
        status_packet(BROADCAST_ID, 0)


def test_packets_are_not_longer_than_their_length_byte_can_say() -> None:
    assert len(instruction_packet(1, WRITE, bytes(253))) == 259
    with pytest.raises(ValueError, match="do not fit"):
        instruction_packet(1, WRITE, bytes(254))
