"""A servo's control table as bytes, and what may be written into it."""

from typing import Final

from hardware.bus.packets import ERROR_ANGLE_LIMIT, ERROR_RANGE
from hardware.servos.control_tables import Register, ServoModel

WRITABLE_WHEN_LOCKED: Final = range(24, 36)


class ControlTable:
    """The registers of one servo; values are read and set by name.

    A servo is byte addressed: a write may begin or end inside a register. What counts is the value
    that the register would have afterwards.
    """

    def __init__(self, model: ServoModel) -> None:
        self._registers = model.registers
        self._bytes = bytearray(max(map(_end, model.registers.values())))
        for name in model.registers:
            self[name] = model.defaults.get(name, 0)
        self["model_number"] = model.model_number

    def __contains__(self, name: str) -> bool:
        return name in self._registers

    def __getitem__(self, name: str) -> int:
        return _value(self._registers[name], self._bytes)

    def __setitem__(self, name: str, value: int) -> None:
        register = self._registers[name]
        encoded = value.to_bytes(register.size, "little")
        self._bytes[register.address : _end(register)] = encoded

    def read(self, address: int, count: int) -> bytes | None:
        """`count` bytes from an address on; None if there are not so many."""
        if count == 0 or address + count > len(self._bytes):
            return None
        return bytes(self._bytes[address : address + count])

    def refusal(self, address: int, data: bytes) -> int:
        """The error bits with which this write is refused; 0 if it may be done."""
        addresses = range(address, address + len(data))
        touched = self._touched(addresses)
        owned = {owned for register in touched for owned in _addresses(register)}
        if not data or not owned.issuperset(addresses):
            return ERROR_RANGE
        if self["lock"] and not all(place in WRITABLE_WHEN_LOCKED for place in addresses):
            return ERROR_RANGE
        after = bytearray(self._bytes)
        after[address : address + len(data)] = data
        for register in touched:
            if not register.writable or _value(register, after) > register.highest:
                return ERROR_RANGE
        goal = self._registers["goal_position"]
        if goal in touched and not self._within_limits(_value(goal, after)):
            return ERROR_ANGLE_LIMIT
        return 0

    def write(self, address: int, data: bytes) -> frozenset[str]:
        """Write bytes that are not refused; the names of the registers that they touch."""
        self._bytes[address : address + len(data)] = data
        touched = self._touched(range(address, address + len(data)))
        return frozenset(register.name for register in touched)

    @property
    def endless_turn(self) -> bool:
        """Whether both angle limits are 0: the servo is a wheel, and goals mean nothing."""
        return self["cw_angle_limit"] == self["ccw_angle_limit"] == 0

    def _within_limits(self, goal: int) -> bool:
        return self.endless_turn or self["cw_angle_limit"] <= goal <= self["ccw_angle_limit"]

    def _touched(self, addresses: range) -> list[Register]:
        registers = self._registers.values()
        return [each for each in registers if not set(addresses).isdisjoint(_addresses(each))]


def _end(register: Register) -> int:
    return register.address + register.size


def _addresses(register: Register) -> range:
    return range(register.address, _end(register))


def _value(register: Register, memory: bytearray) -> int:
    return int.from_bytes(memory[register.address : _end(register)], "little")
