"""One simulated servo: its control table, how it turns, and what it answers."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from hardware.bus.packets import (
    ACTION,
    ERROR_CHECKSUM,
    ERROR_INSTRUCTION,
    ERROR_OVERHEATING,
    ERROR_OVERLOAD,
    ERROR_RANGE,
    ERROR_VOLTAGE,
    PING,
    READ,
    REG_WRITE,
    RESET,
    WRITE,
    InstructionPacket,
    status_packet,
)
from hardware.servos.control_tables import SIMULATED_FIRMWARE, ServoModel
from hardware.servos.units import SIGN_BIT, SPEED_UNIT_RAD_S, speed_rad_s, ticks_per_radian
from hardware.simulator.memory import ControlTable

Clock = Callable[[], float]
"""Says the time [s]; only differences count."""

ONE_MEGABAUD: Final = 1
USUAL_VOLTAGE: Final = 160
USUAL_TEMPERATURE: Final = 35
SLAVE_MODE: Final = 1 << 1
TURNING_LOAD: Final = 100
NO_CURRENT: Final = 512

ANSWERS_READS: Final = 1
ANSWERS_ALL: Final = 2


@dataclass
class ServoFaults:
    """What is wrong with a servo on purpose; `faults.py` sets it.

    Attributes:
        slip_ticks: what the position sensor says too much.
    """

    missing: bool = False
    jammed: bool = False
    overloaded: bool = False
    slip_ticks: int = 0


class SimulatedServo:
    """A servo at a bus id. Its position is worked out whenever somebody asks.

    Args:
        servo_id: id on the bus.
        model: the kind of servo.
        position: where it stands at the start [ticks].
        clock: what its turning is timed by.
        noise: drawn and added at each reading of the position [ticks].
        master: for one of a pair on a sync cable, the servo that it follows.

    Attributes:
        mate: the other servo on the same shaft, which carries this one along when it has no torque.
    """

    def __init__(
        self,
        servo_id: int,
        model: ServoModel,
        position: float,
        clock: Clock,
        noise: Callable[[], int] = lambda: 0,
        master: "SimulatedServo | None" = None,
    ) -> None:
        self.model = model
        self.faults = ServoFaults()
        self._position = position
        self._clock = clock
        self._evaluated_at = clock()
        self._noise = noise
        self._master = master
        self.mate: SimulatedServo | None = None
        self._registered: tuple[int, bytes] | None = None
        self.table = self._new_table(servo_id, ONE_MEGABAUD)
        if master is not None:
            self.table["drive_mode"] = SLAVE_MODE
        self._power_on()

    @property
    def servo_id(self) -> int:
        """The id under which it answers now."""
        return self.table["id"]

    @property
    def position(self) -> float:
        """Where it really stands now [ticks]."""
        self.advance()
        return self._position

    def handle(self, packet: InstructionPacket) -> bytes | None:
        """Do what a packet says and give the status packet; None if the return level has none.

        The caller has checked that the packet is for this servo, and keeps the answer to itself if
        the packet was a broadcast.
        """
        # A change of id or return level holds from the next instruction on.
        servo_id, level = self.servo_id, self.table["status_return_level"]
        if packet.checksum_valid:
            errors, parameters = self._execute(packet.instruction, packet.parameters)
        else:
            errors, parameters = ERROR_CHECKSUM, b""
        errors |= self._protect(errors)
        answered = {PING: 0, READ: ANSWERS_READS}.get(packet.instruction, ANSWERS_ALL)
        if not packet.checksum_valid:
            answered = ANSWERS_ALL
        return status_packet(servo_id, errors, parameters) if level >= answered else None

    def write(self, address: int, data: bytes) -> int:
        """Write bytes, or nothing and say why in error bits."""
        errors = self.table.refusal(address, data)
        if not errors:
            self.advance()
            touched = self.table.write(address, data)
            # The e-manual of RX and EX does not say it, but drivers of this family rely on it: a
            # goal switches the torque on. It is the case in which a careless program moves an arm.
            if "goal_position" in touched and self._leader is None:
                self.table["torque_enable"] = 1
        return self._protect(errors)

    def advance(self) -> None:
        """Turn as far as the time since the last look allows."""
        now = self._clock()
        elapsed_s, self._evaluated_at = now - self._evaluated_at, now
        if self._stuck:
            return
        carrier = self._leader or self._carrier
        if carrier is not None:
            self._position = self.model.highest_position - carrier.position
        elif self._driven:
            way = self.table["goal_position"] - self._position
            farthest = self._speed_rad_s * ticks_per_radian(self.model) * elapsed_s
            self._position += max(-farthest, min(way, farthest))

    def power_cycle(self) -> None:
        """Off and on: what is not kept without power is as after power-on; it stays where it is."""
        self.advance()
        kept = {
            name: self.table[name]
            for name, register in self.model.registers.items()
            if register.survives_power_off
        }
        voltage, temperature = self.table["present_voltage"], self.table["present_temperature"]
        self.table = self._new_table(self.servo_id, self.table["baud_rate"])
        for name, value in kept.items():
            self.table[name] = value
        # Without torque there is no load; heat and the supply are as they were.
        self.faults.overloaded = False
        self.table["present_voltage"] = voltage
        self.table["present_temperature"] = temperature
        self._power_on()

    def protect(self) -> None:
        """Shut down if something that stands is to shut it down."""
        self.advance()
        self._protect(0)

    @property
    def _leader(self) -> "SimulatedServo | None":
        """The servo that moves this one by the sync cable, while it is set up as a slave."""
        if self._master is None or not self.table["drive_mode"] & SLAVE_MODE:
            return None
        return self._master

    @property
    def _carrier(self) -> "SimulatedServo | None":
        """The servo on the same shaft, while it alone has torque."""
        return self.mate if self.mate is not None and self.mate._driven > self._driven else None

    @property
    def _stuck(self) -> bool:
        return self.faults.jammed or (self.mate is not None and self.mate.faults.jammed)

    @property
    def _driven(self) -> bool:
        table = self.table
        powered = table["torque_enable"] == 1 and table["torque_limit"] > 0
        return powered and not table.endless_turn

    @property
    def _speed_rad_s(self) -> float:
        full = self.model.no_load_rpm * math.tau / 60
        commanded = self.table["moving_speed"]
        return full if commanded == 0 else min(speed_rad_s(commanded), full)

    @property
    def _direction(self) -> int:
        """1 counter-clockwise, -1 clockwise, 0 at the goal or without torque."""
        if self._leader is not None:
            return -self._leader._direction
        way = self.table["goal_position"] - self._position if self._driven else 0
        return (way > 0) - (way < 0)

    def _execute(self, instruction: int, parameters: bytes) -> tuple[int, bytes]:
        if instruction == PING:
            return 0, b""
        if instruction == READ and len(parameters) == 2:
            return self._read(*parameters)
        if instruction == WRITE and parameters:
            return self.write(parameters[0], parameters[1:]), b""
        if instruction == REG_WRITE and parameters:
            return self._register(parameters[0], parameters[1:]), b""
        if instruction == ACTION:
            return self._action(), b""
        if instruction == RESET:
            self._reset()
            return 0, b""
        return ERROR_INSTRUCTION, b""

    def _read(self, address: int, count: int) -> tuple[int, bytes]:
        self.advance()
        self._refresh()
        found = self.table.read(address, count)
        return (ERROR_RANGE, b"") if found is None else (0, found)

    def _register(self, address: int, data: bytes) -> int:
        errors = self.table.refusal(address, data)
        if not errors:
            self._registered = (address, data)
        return errors

    def _action(self) -> int:
        if self._registered is None:
            return ERROR_INSTRUCTION
        (address, data), self._registered = self._registered, None
        return self.write(address, data)

    def _reset(self) -> None:
        # A real servo goes back to id 1 and 57,600 baud, too, and then two have the same id.
        self.advance()
        self.table = self._new_table(self.servo_id, self.table["baud_rate"])
        self._power_on()

    def _refresh(self) -> None:
        table, faults = self.table, self.faults
        seen = round(self._position) + faults.slip_ticks + self._noise()
        table["present_position"] = max(0, min(seen, self.model.highest_position))
        direction, mover = self._direction, self._leader or self
        stuck = self._stuck or mover.faults.jammed
        speed = 0 if stuck else round(mover._speed_rad_s / SPEED_UNIT_RAD_S)
        load = mover.table["torque_limit"] if stuck else TURNING_LOAD
        table["present_speed"] = _signed(direction, speed)
        table["present_load"] = _signed(direction, load)
        table["moving"] = abs(direction)
        table["registered_instruction"] = int(self._registered is not None)

    def _standing_errors(self) -> int:
        table = self.table
        errors = ERROR_OVERLOAD if self.faults.overloaded else 0
        if not table["lowest_voltage"] <= table["present_voltage"] <= table["highest_voltage"]:
            errors |= ERROR_VOLTAGE
        if table["present_temperature"] > table["temperature_limit"]:
            errors |= ERROR_OVERHEATING
        return errors

    def _protect(self, errors: int) -> int:
        errors |= self._standing_errors()
        if errors & self.table["shutdown"]:
            self.table["torque_limit"] = 0
        return errors

    def _new_table(self, servo_id: int, baud_rate: int) -> ControlTable:
        table = ControlTable(self.model)
        table["firmware_version"] = SIMULATED_FIRMWARE
        table["id"] = servo_id
        table["baud_rate"] = baud_rate
        table["present_voltage"] = USUAL_VOLTAGE
        table["present_temperature"] = USUAL_TEMPERATURE
        if "sensed_current" in table:
            table["sensed_current"] = NO_CURRENT
        return table

    def _power_on(self) -> None:
        self._registered = None
        self.table["torque_limit"] = self.table["max_torque"]
        self.table["goal_position"] = round(self._position)
        self._protect(0)


def _signed(direction: int, size: int) -> int:
    """A speed or a load as its register has it: bit 10 set for clockwise."""
    if direction == 0:
        return 0
    return size | SIGN_BIT if direction < 0 else size
