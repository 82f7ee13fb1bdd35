"""Fault commands: lines of text that break the simulated servos on purpose, and mend them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from hardware.simulator.bus import SimulatedBus
from hardware.simulator.servo import (
    ANSWERS_ALL,
    USUAL_TEMPERATURE,
    USUAL_VOLTAGE,
    ServoFaults,
    SimulatedServo,
)


class FaultRefused(ValueError):
    """A line that is no fault command, or one with arguments that make no sense."""


@dataclass(frozen=True)
class FaultCommand:
    """A command: its arguments' names in order, what it does in words, and how."""

    arguments: tuple[str, ...]
    help: str
    apply: Callable[[SimulatedBus, Sequence[str]], None]


def apply_fault(bus: SimulatedBus, line: str) -> None:
    """Do what a line says; an empty line says nothing.

    Raises:
        FaultRefused: with a message of one line.
    """
    name, *arguments = line.split() or [""]
    if not name:
        return
    command = FAULTS.get(name)
    if command is None:
        raise FaultRefused(f"no fault {name!r}; known: {', '.join(FAULTS)}")
    if len(arguments) != len(command.arguments):
        raise FaultRefused(f"usage: {' '.join((name, *command.arguments))}")
    command.apply(bus, arguments)


def _missing(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    _servo(bus, arguments[0]).faults.missing = True


def _overload(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.faults.overloaded = True
    servo.protect()


def _overheat(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.table["present_temperature"] = servo.table["temperature_limit"] + 1
    servo.protect()


def _voltage(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.table["present_voltage"] = max(0, servo.table["lowest_voltage"] - 1)
    servo.protect()


def _jam(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.advance()
    servo.faults.jammed = True


def _slip(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.faults.slip_ticks = _whole(arguments[1], "TICKS", -4095, 4095)


def _return_level(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    servo = _servo(bus, arguments[0])
    servo.table["status_return_level"] = _whole(arguments[1], "LEVEL", 0, ANSWERS_ALL)


def _corrupt(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    try:
        share = float(arguments[0])
    except ValueError:
        share = math.nan
    if not 0 <= share <= 1:
        raise FaultRefused(f"SHARE is a number from 0 to 1, not {arguments[0]!r}")
    bus.corrupt_share = share


def _corrupt_next(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    bus.corrupt_next = _whole(arguments[0], "COUNT", 0, 1_000_000)


def _silent(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    bus.silent = True


def _heal(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    bus.silent, bus.corrupt_share, bus.corrupt_next = False, 0.0, 0
    for servo in bus.servos:
        # Bring it up to now first, or what was jammed would catch up for the time it stood.
        servo.advance()
        servo.faults = ServoFaults()
        servo.table["present_voltage"] = USUAL_VOLTAGE
        servo.table["present_temperature"] = USUAL_TEMPERATURE
        servo.table["status_return_level"] = ANSWERS_ALL


def _power_cycle(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    for servo in bus.servos:
        servo.power_cycle()


def _unplug(bus: SimulatedBus, arguments: Sequence[str]) -> None:
    bus.unplugged = True


FAULTS: Final[Mapping[str, FaultCommand]] = MappingProxyType(
    {
        "missing": FaultCommand(("ID",), "The servo does not answer or listen.", _missing),
        "overload": FaultCommand(
            ("ID",), "The load is too much: the servo says so and shuts down.", _overload
        ),
        "overheat": FaultCommand(
            ("ID",), "One degree over its limit: the servo says so and shuts down.", _overheat
        ),
        "voltage": FaultCommand(("ID",), "The supply is too low: the servo says so.", _voltage),
        "jam": FaultCommand(("ID",), "The servo does not turn any more; no error.", _jam),
        "slip": FaultCommand(
            ("ID", "TICKS"), "The position sensor is off by so many ticks.", _slip
        ),
        "return-level": FaultCommand(
            ("ID", "LEVEL"), "Sets the status return level: 2, 1 or 0.", _return_level
        ),
        "corrupt": FaultCommand(
            ("SHARE",), "This share of answers, 0 to 1, has a wrong checksum.", _corrupt
        ),
        "corrupt-next": FaultCommand(
            ("COUNT",), "The next so many answers have a wrong checksum.", _corrupt_next
        ),
        "silent": FaultCommand((), "Nothing answers or listens any more.", _silent),
        "heal": FaultCommand(
            (), "Undoes all of the above; a torque limit of 0 stays after a shutdown.", _heal
        ),
        "power-cycle": FaultCommand(
            (), "All servos off and on: torque off, torque limit back, no overload.", _power_cycle
        ),
        "unplug": FaultCommand((), "The device goes away and the program ends.", _unplug),
    }
)


def _servo(bus: SimulatedBus, text: str) -> SimulatedServo:
    ids = [str(servo.servo_id) for servo in bus.servos]
    if text not in ids:
        raise FaultRefused(f"no servo {text!r}; known: {', '.join(ids)}")
    return bus.servos[ids.index(text)]


def _whole(text: str, name: str, lowest: int, highest: int) -> int:
    try:
        value = int(text)
    except ValueError:
        value = lowest - 1
    if not lowest <= value <= highest:
        raise FaultRefused(f"{name} is a whole number from {lowest} to {highest}, not {text!r}")
    return value
