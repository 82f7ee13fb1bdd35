"""Parts that the tests of this package share: an arm on simulated servos, in this process."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

from hardware.arm.servo_arm import ServoArm
from hardware.bus.bus import StatusReply
from hardware.bus.packets import (
    BROADCAST_ID,
    READ,
    SYNC_WRITE,
    WRITE,
    checksum,
    error_names,
    instruction_packet,
)
from hardware.clock import RobotClock
from hardware.exceptions import BusLost, CorruptPackets, ServoMissing
from hardware.link.messages import Execute, SegmentTimes, TargetMotion
from hardware.servos.instances import load_instance
from hardware.servos.joints import MIRRORED, ArmMap, load_arm
from hardware.simulator.bus import SimulatedBus, simulated_arm
from hardware.simulator.faults import apply_fault
from hardware.simulator.servo import SimulatedServo
from solver import Options, Plan, Problem, Robot, Target, solve

DATA_SET_3 = (
    Target("1", (0.185, -0.057, 0.42), (-1, -1, 1)),
    Target("2", (0.18, -0.07, 0.425), (-1, -1, 1)),
    Target("3", (0.16, -0.083, 0.435), (-1, -1, 0)),
    Target("4", (0.15, -0.089, 0.445), (-1, -1, 0)),
    Target("5", (0.14, -0.095, 0.45), (-1, -1, 0)),
)


@dataclass
class FakeTime:
    """A wall clock that passes only when somebody sleeps; the next sleep may last longer."""

    now_s: float = 1000.0
    oversleep_s: float = 0.0

    def monotonic(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds + self.oversleep_s
        self.oversleep_s = 0.0


@dataclass
class InProcessBus:
    """A `hardware.bus.bus.ServoBus` that hands its packets to a simulated bus at once.

    Attributes:
        sent: every instruction packet, as bytes.
        gone: the device is lost.
    """

    simulated: SimulatedBus
    sent: list[bytes] = field(default_factory=list)
    gone: bool = False
    device: str = "in-process"
    retries: Mapping[int, int] = field(default_factory=dict)

    def read(self, servo_id: int, address: int, size: int) -> StatusReply:
        return self._ask(servo_id, READ, bytes((address, size)))

    def write(self, servo_id: int, address: int, data: bytes) -> StatusReply:
        return self._ask(servo_id, WRITE, bytes((address, *data)))

    def sync_write(self, address: int, rows: Mapping[int, bytes]) -> None:
        (size,) = {len(data) for data in rows.values()}
        shares = b"".join(bytes((servo_id, *data)) for servo_id, data in rows.items())
        self._send(instruction_packet(BROADCAST_ID, SYNC_WRITE, bytes((address, size)) + shares))

    def reopen(self) -> None:
        self.gone = False

    def close(self) -> None:
        pass

    def _ask(self, servo_id: int, instruction: int, parameters: bytes) -> StatusReply:
        answer = self._send(instruction_packet(servo_id, instruction, parameters))
        if not answer:
            raise ServoMissing(servo_id, "does not answer")
        if answer[-1] != checksum(answer[2:-1]):
            raise CorruptPackets(servo_id, "answers unreadably")
        return StatusReply(answer[5:-1], error_names(answer[4]))

    def _send(self, packet: bytes) -> bytes:
        if self.gone:
            raise BusLost("in-process is gone")
        self.sent.append(packet)
        return self.simulated.respond(packet)


@dataclass(frozen=True)
class Sent:
    """What an instruction packet says.

    Attributes:
        servo_id: whom it is for; BROADCAST_ID in a sync write.
        address: the first register that it reads or writes.
        rows: of a sync write goal and speed by servo id [counts], of others nothing.
    """

    servo_id: int
    instruction: int
    address: int
    rows: Mapping[int, tuple[int, int]]


def told(packets: Sequence[bytes]) -> list[Sent]:
    """Instruction packets taken apart."""
    return [Sent(packet[2], packet[4], packet[5], _rows(packet)) for packet in packets]


def goals_sent(packets: Sequence[bytes]) -> list[Mapping[int, tuple[int, int]]]:
    """Goals and speeds by servo id [counts], of each packet that has any."""
    return [sent.rows for sent in told(packets) if sent.instruction == SYNC_WRITE]


def _rows(packet: bytes) -> Mapping[int, tuple[int, int]]:
    if packet[4] != SYNC_WRITE:
        return {}
    assert packet[5:7] == bytes((30, 4)), "goal position and moving speed, two bytes each"
    shares = [packet[i : i + 5] for i in range(7, len(packet) - 1, 5)]
    return {
        share[0]: (int.from_bytes(share[1:3], "little"), int.from_bytes(share[3:5], "little"))
        for share in shares
    }


@dataclass(frozen=True)
class Bench:
    """An arm on simulated servos, and the time that both live in."""

    robot: Robot
    map: ArmMap
    arm: ServoArm
    bus: InProcessBus
    time: FakeTime

    def fault(self, command: str) -> None:
        apply_fault(self.bus.simulated, command)

    def servo(self, servo_id: int) -> SimulatedServo:
        servo = self.bus.simulated.servo(servo_id)
        assert servo is not None
        return servo

    def true_joints(self) -> list[float]:
        servos = {servo.servo_id: servo.position for servo in self.bus.simulated.servos}
        return list(self.map.joints(servos).tolist())


def make_bench(
    start: tuple[float, ...] | None = None,
    *,
    seed: int = 0,
    coupling_of_joint_2: str = MIRRORED,
    noise_ticks: int = 1,
) -> Bench:
    """An arm that stands at `start` [rad], or at home; without noise its servos say where."""
    robot = load_instance("tabletop").robot
    arm_map = load_arm(robot, "tabletop")
    first, second, *others = arm_map.drives
    second = replace(second, coupling=coupling_of_joint_2)
    arm_map = replace(arm_map, drives=(first, second, *others))
    time = FakeTime()
    clock = RobotClock(monotonic=time.monotonic, sleep=time.sleep)
    joints = start or robot.home_joints
    simulated = simulated_arm(arm_map, joints, time.monotonic, seed, noise_ticks)
    bus = InProcessBus(simulated)
    return Bench(robot, arm_map, ServoArm(robot, arm_map, bus, clock), bus, time)


@cache
def plan_of_data_set_3(dwell_s: float = 0.2) -> Plan:
    """Five targets, by the fastest method."""
    robot = load_instance("tabletop").robot
    return solve(Problem(robot, DATA_SET_3, options=Options(method="ssas", dwell_s=dwell_s)))


def messages_of(plan: Plan, execution_id: str = "e1") -> tuple[Execute, list[TargetMotion]]:
    """What the service sends for a plan."""
    motions: list[TargetMotion] = []
    for approach in plan.approaches:
        if approach.trajectory is None:
            continue
        assert approach.standby_joints is not None
        assert approach.thinning_joints is not None
        motions.append(
            TargetMotion(
                execution_id=execution_id,
                index=len(motions),
                target_id=approach.target_id,
                standby_joints=tuple(approach.standby_joints.tolist()),
                thinning_joints=tuple(approach.thinning_joints.tolist()),
                times_s=tuple(approach.trajectory.times_s.tolist()),
                joints=tuple(map(tuple, approach.trajectory.joints.tolist())),
                segments=tuple(
                    SegmentTimes(part.name, part.start_s, part.end_s)
                    for part in approach.trajectory.segments
                ),
            )
        )
    problem = plan.problem
    execute = Execute(
        execution_id=execution_id,
        plan_id="p1",
        tool=problem.mounted_tool.name,
        model_version=problem.robot.version,
        start_joints=problem.start,
        target_count=len(motions),
    )
    return execute, motions
