"""The servos of an arm, register by register: what is read from them, and the little written."""

import contextlib
from collections.abc import Mapping

from hardware.bus.bus import ServoBus, StatusReply
from hardware.clock import timestamp
from hardware.exceptions import BusLost, CorruptPackets, ServoAlarm, ServoMissing, WrongSetting
from hardware.link.messages import ServoHealth
from hardware.servos.joints import ArmMap, JointDrive, Motor
from hardware.servos.units import load_share, voltage_v
from solver import Array


class ServoChain:
    """All servos of an arm on one bus, and what each said last.

    It writes goal position, moving speed and torque enable, and nothing else. Not the torque limit:
    after a shutdown that is 0, and writing it would put the joint under power again.
    """

    def __init__(self, arm: ArmMap, bus: ServoBus) -> None:
        self.map = arm
        self.bus = bus
        self._health: dict[int, ServoHealth] = {}
        self._positions: dict[int, int] = {}
        self._powered: dict[int, bool] = {}

    # --- Reading ----------------------------------------------------------------------------------
    def value(self, motor: Motor, name: str) -> int:
        """A register's value.

        Raises:
            HardwareError: the servo does not answer, or reports an error.
        """
        register = motor.servo.registers[name]
        reply = self.bus.read(motor.id, register.address, register.size)
        _raise_alarm(motor.id, reply)
        return int.from_bytes(reply.data, "little")

    def read_drive(self, drive: JointDrive) -> tuple[float, ...]:
        """What each motor of a joint says about the first one's count; raises like `value`."""
        for motor in drive.motors:
            _raise_alarm(motor.id, self._read_health(drive, motor))
        return drive.first_motor_ticks(self._positions)

    def sweep(self) -> dict[int, int]:
        """Counts of all servos from one read of each, by id; raises like `value`."""
        for drive in self.map.drives:
            self.read_drive(drive)
        return dict(self._positions)

    def values_of_what_answers(self, name: str) -> dict[int, int]:
        """A register of every servo that answers, whatever errors it reports, by id.

        Raises:
            BusLost: the device is gone.
        """
        values: dict[int, int] = {}
        for motor in self.map.motors:
            register = motor.servo.registers[name]
            with contextlib.suppress(ServoMissing, CorruptPackets):
                reply = self.bus.read(motor.id, register.address, register.size)
                values[motor.id] = int.from_bytes(reply.data, "little")
        return values

    def survey(self) -> dict[int, int]:
        """Counts from one read of every servo that answers, whatever errors it reports, by id.

        Raises:
            BusLost: the device is gone.
        """
        found: dict[int, int] = {}
        for drive in self.map.drives:
            for motor in drive.motors:
                with contextlib.suppress(ServoMissing, CorruptPackets):
                    self._read_health(drive, motor)
                    found[motor.id] = self._positions[motor.id]
        return found

    def last_posture(self) -> tuple[Array, str] | None:
        """The posture from the last read of every servo, and when the oldest read was made."""
        if len(self._positions) < len(self.map.motors):
            return None
        read_at = min(health.read_at for health in self._health.values())
        return self.map.joints(self._positions), read_at

    @property
    def powered(self) -> Mapping[int, bool]:
        """Whether each servo is under power, by id; without those that did not answer last."""
        return self._powered

    def health(self) -> tuple[ServoHealth, ...]:
        """What every servo said last, in joint order."""
        return tuple(self._health[m.id] for m in self.map.motors if m.id in self._health)

    # --- Writing ----------------------------------------------------------------------------------
    def send(self, goals: Mapping[int, int], speeds: Mapping[int, int]) -> None:
        """Goal positions and moving speeds, in one packet that nobody answers [counts]."""
        registers = self.map.motors[0].servo.registers
        goal, speed = registers["goal_position"], registers["moving_speed"]
        rows = {
            servo_id: ticks.to_bytes(goal.size, "little")
            + speeds[servo_id].to_bytes(speed.size, "little")
            for servo_id, ticks in goals.items()
        }
        self.bus.sync_write(goal.address, rows)

    def enable_torque(self, motor: Motor) -> None:
        """Put a servo under power, and read back that it is; raises like `expect`."""
        register = motor.servo.registers["torque_enable"]
        _raise_alarm(motor.id, self.bus.write(motor.id, register.address, register.encode(1)))
        self.expect(motor, "torque_enable", 1)

    def expect(self, motor: Motor, name: str, wanted: int) -> None:
        """Check that a register holds what was written.

        Raises:
            WrongSetting: it does not.
            HardwareError: the servo does not answer, or reports an error.
        """
        found = self.value(motor, name)
        if found != wanted:
            raise WrongSetting(motor.id, f"{name} reads {found} after {wanted} was written")

    def _read_health(self, drive: JointDrive, motor: Motor) -> StatusReply:
        registers = motor.servo.registers
        first, last = registers["torque_enable"], registers["present_temperature"]
        size = last.address + last.size - first.address
        self._powered.pop(motor.id, None)
        try:
            reply = self.bus.read(motor.id, first.address, size)
        except BusLost:
            self._powered.clear()
            raise

        def value(name: str) -> int:
            register = registers[name]
            start = register.address - first.address
            return int.from_bytes(reply.data[start : start + register.size], "little")

        ticks = value("present_position")
        if ticks > motor.servo.highest_position:
            raise CorruptPackets(motor.id, f"says that it stands at {ticks}, which it cannot")
        powered = value("torque_enable") == 1 and value("torque_limit") > 0
        self._powered[motor.id] = powered
        own = ticks if motor is drive.motors[0] else drive.mirrored(ticks)
        self._positions[motor.id] = ticks
        self._health[motor.id] = ServoHealth(
            id=motor.id,
            joint=drive.joint,
            torque=powered,
            position_rad=drive.angle(own),
            load_share=load_share(value("present_load")),
            voltage_v=voltage_v(value("present_voltage")),
            temperature_c=value("present_temperature"),
            errors=reply.errors,
            retries=self.bus.retries.get(motor.id, 0),
            read_at=timestamp(),
        )
        return reply


def _raise_alarm(servo_id: int, reply: StatusReply) -> None:
    if reply.errors:
        raise ServoAlarm(servo_id, reply.errors)
