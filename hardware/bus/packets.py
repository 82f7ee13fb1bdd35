"""Packets of Dynamixel Protocol 1.0 as bytes, no port involved.

An instruction packet is FF FF, id, length, instruction, parameters, checksum; a status packet has
an error byte in place of the instruction. Length counts what follows it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

HEADER: Final = b"\xff\xff"
BROADCAST_ID: Final = 254
HIGHEST_ID: Final = 253

PING: Final = 0x01
READ: Final = 0x02
WRITE: Final = 0x03
REG_WRITE: Final = 0x04
ACTION: Final = 0x05
RESET: Final = 0x06
SYNC_WRITE: Final = 0x83
BULK_READ: Final = 0x92

ERROR_VOLTAGE: Final = 1 << 0
ERROR_ANGLE_LIMIT: Final = 1 << 1
ERROR_OVERHEATING: Final = 1 << 2
ERROR_RANGE: Final = 1 << 3
ERROR_CHECKSUM: Final = 1 << 4
ERROR_OVERLOAD: Final = 1 << 5
ERROR_INSTRUCTION: Final = 1 << 6

# By bit. The last has no meaning in the protocol; it has a name so that no set bit goes unseen.
ERROR_NAMES: Final = (
    "voltage",
    "angle_limit",
    "overheating",
    "range",
    "checksum",
    "overload",
    "instruction",
    "unknown",
)

_BEFORE_LENGTH: Final = len(HEADER) + 1
_AROUND_LENGTH: Final = _BEFORE_LENGTH + 1
_SHORTEST_LENGTH: Final = 2
_MOST_PARAMETERS: Final = 255 - _SHORTEST_LENGTH


@dataclass(frozen=True)
class InstructionPacket:
    """An instruction as it came over the bus, whether or not its checksum is right."""

    servo_id: int
    instruction: int
    parameters: bytes
    checksum_valid: bool = True


def checksum(body: bytes) -> int:
    """The checksum over a packet's bytes from the id to the last parameter."""
    return ~sum(body) & 0xFF


def instruction_packet(servo_id: int, instruction: int, parameters: bytes = b"") -> bytes:
    """The bytes of an instruction; ValueError if the id or the length does not fit."""
    if not 0 <= servo_id <= BROADCAST_ID:
        raise ValueError(f"{servo_id} is not an id")
    return _packet(servo_id, instruction, parameters)


def status_packet(servo_id: int, error: int, parameters: bytes = b"") -> bytes:
    """The bytes of an answer; ValueError if the id or the length does not fit."""
    if not 0 <= servo_id <= HIGHEST_ID:
        raise ValueError(f"{servo_id} is not a servo's id")
    return _packet(servo_id, error, parameters)


def error_names(error: int) -> tuple[str, ...]:
    """Every error that a status packet's error byte says, in the order of its bits."""
    return tuple(name for bit, name in enumerate(ERROR_NAMES) if error >> bit & 1)


class PacketReader:
    """Finds instruction packets in a stream of bytes, however the stream is cut up.

    Bytes that cannot begin a packet are skipped. A packet with a wrong checksum is reported, and
    the search goes on inside it, because its length may be the byte that is wrong.
    """

    def __init__(self) -> None:
        self._waiting = bytearray()

    def feed(self, data: bytes) -> Iterator[InstructionPacket]:
        """The packets that these bytes complete."""
        self._waiting += data
        while (packet := self._next()) is not None:
            yield packet

    def _next(self) -> InstructionPacket | None:
        while True:
            self._skip_to_header()
            waiting = self._waiting
            if len(waiting) < _AROUND_LENGTH:
                return None
            length = waiting[_BEFORE_LENGTH]
            # FF is no id: of three FF in a row, the header is the last two.
            if waiting[len(HEADER)] > BROADCAST_ID or length < _SHORTEST_LENGTH:
                del waiting[0]
                continue
            end = _AROUND_LENGTH + length
            if len(waiting) < end:
                return None
            packet = _parsed(bytes(waiting[:end]))
            del waiting[: end if packet.checksum_valid else len(HEADER)]
            return packet

    def _skip_to_header(self) -> None:
        waiting = self._waiting
        start = waiting.find(HEADER)
        if start < 0:
            start = len(waiting) - waiting.endswith(HEADER[:1])
        del waiting[:start]


def _packet(servo_id: int, code: int, parameters: bytes) -> bytes:
    if len(parameters) > _MOST_PARAMETERS:
        raise ValueError(f"{len(parameters)} parameters do not fit into a packet")
    body = bytes((servo_id, len(parameters) + _SHORTEST_LENGTH, code)) + parameters
    return HEADER + body + bytes((checksum(body),))


def _parsed(packet: bytes) -> InstructionPacket:
    body = packet[len(HEADER) : -1]
    return InstructionPacket(
        servo_id=body[0],
        instruction=body[2],
        parameters=body[3:],
        checksum_valid=packet[-1] == checksum(body),
    )
