"""The simulated bus: every servo of an arm behind one stream of bytes."""

import random
from collections.abc import Iterator, Sequence

from hardware.bus.packets import BROADCAST_ID, SYNC_WRITE, InstructionPacket, PacketReader
from hardware.exceptions import InvalidArm, OutsideLimits
from hardware.servos.joints import SYNC_CABLE, ArmMap, JointDrive
from hardware.simulator.servo import Clock, SimulatedServo


class SimulatedBus:
    """Servos on one line. Bytes go in, the bytes of their answers come out.

    Attributes:
        servos: in the order in which they answer.
        silent: nothing answers and nothing is heard.
        corrupt_share: the share of answers that get a wrong checksum.
        corrupt_next: how many answers from now on get a wrong checksum.
        unplugged: the adapter is gone; whoever runs the bus ends it.
    """

    def __init__(self, servos: Sequence[SimulatedServo], seed: int = 0) -> None:
        self.servos = tuple(servos)
        self.silent = False
        self.corrupt_share = 0.0
        self.corrupt_next = 0
        self.unplugged = False
        self._random = random.Random(seed)
        self._reader = PacketReader()

    def servo(self, servo_id: int) -> SimulatedServo | None:
        """The servo that has this id now, or None."""
        return next((servo for servo in self.servos if servo.servo_id == servo_id), None)

    def respond(self, data: bytes) -> bytes:
        """What the servos answer to these bytes; packets may be cut anywhere."""
        return b"".join(map(self._on_the_line, self._answers(data)))

    def _answers(self, data: bytes) -> Iterator[bytes]:
        for packet in self._reader.feed(data):
            if self.silent:
                continue
            listening = [servo for servo in self.servos if not servo.faults.missing]
            if packet.servo_id == BROADCAST_ID:
                _broadcast(packet, listening)
                continue
            # Two servos with one id both answer. On a real line they would garble each other.
            addressed = [servo for servo in listening if servo.servo_id == packet.servo_id]
            yield from filter(None, [servo.handle(packet) for servo in addressed])

    def _on_the_line(self, answer: bytes) -> bytes:
        corrupt = self.corrupt_next > 0 or self._random.random() < self.corrupt_share
        self.corrupt_next = max(0, self.corrupt_next - 1)
        return answer[:-1] + bytes((answer[-1] ^ 0xFF,)) if corrupt else answer


def simulated_arm(
    arm: ArmMap,
    joints_rad: Sequence[float],
    clock: Clock,
    seed: int = 0,
    noise_ticks: int = 1,
) -> SimulatedBus:
    """The servos of an arm, standing at a joint vector [rad].

    Args:
        arm: which servos there are and what their ticks mean.
        joints_rad: where the arm stands at the start, in the arm's joint order [rad].
        clock: what the turning is timed by.
        seed: of the reading noise and of corruption.
        noise_ticks: readings of a position are off by up to this, evenly [ticks].

    Raises:
        OutsideLimits: a servo cannot stand there.
        InvalidArm: a sync cable between servos that have none.
    """
    # A stream of its own, so that corruption does not change what is read.
    generator = random.Random(f"noise {seed}")

    def noise() -> int:
        return generator.randint(-noise_ticks, noise_ticks)

    servos: list[SimulatedServo] = []
    for drive, angle in zip(arm.drives, joints_rad, strict=True):
        ticks = _start_ticks(drive, angle)
        first = SimulatedServo(drive.motors[0].id, drive.servo, ticks, clock, noise)
        servos.append(first)
        cable = drive.coupling == SYNC_CABLE
        if cable and "drive_mode" not in drive.servo.registers:
            raise InvalidArm(f"{drive.joint}: {drive.servo.name} has no sync cable")
        for motor in drive.motors[1:]:
            mirrored, master = drive.mirrored(ticks), first if cable else None
            second = SimulatedServo(motor.id, motor.servo, mirrored, clock, noise, master)
            first.mate, second.mate = second, first
            servos.append(second)
    return SimulatedBus(servos, seed)


def _start_ticks(drive: JointDrive, angle_rad: float) -> int:
    if not drive.reaches(angle_rad):
        raise OutsideLimits(drive.joint, f"its servo cannot stand at {angle_rad:.4f} rad")
    return drive.ticks(angle_rad)


def _broadcast(packet: InstructionPacket, servos: Sequence[SimulatedServo]) -> None:
    """Do what a packet for everybody says; nobody answers one."""
    if packet.instruction != SYNC_WRITE:
        for servo in servos:
            servo.handle(packet)
    elif packet.checksum_valid and len(packet.parameters) > 2:
        address, size, *rest = packet.parameters
        shares = [rest[start : start + size + 1] for start in range(0, len(rest), size + 1)]
        for servo_id, *data in shares:
            for servo in servos:
                if servo.servo_id == servo_id and len(data) == size:
                    servo.write(address, bytes(data))
