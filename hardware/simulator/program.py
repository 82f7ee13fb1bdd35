"""The program `prunus servo-bus`: options to a bus, standard streams to commands and messages."""

import sys
from collections.abc import Sequence
from pathlib import Path

from hardware.clock import RobotClock
from hardware.options import BadOption, check_time_factor, joints_from_degrees
from hardware.servos.instances import load_instance
from hardware.servos.joints import load_arm
from hardware.simulator.bus import simulated_arm
from hardware.simulator.faults import FAULTS, apply_fault
from hardware.simulator.pseudo_terminal import serve_bus

MOST_NOISE_TICKS = 1000


def run_servo_bus(
    *,
    robot: str,
    joints_deg: str | None,
    calibration: Path | None,
    link: Path | None,
    faults: Sequence[str],
    seed: int,
    noise_ticks: int,
    time_factor: float,
) -> None:
    """Simulate an arm's servos until a signal or a command ends it.

    The first line on standard output is the device's path, and nothing else goes there.

    Raises:
        BadOption: an option's value makes no sense.
        FaultRefused: a fault to begin with is no fault command.
        UnknownRobot, HardwareError: no such robot, arm, calibration or link, or a start where a
            servo cannot stand.
    """
    if not 0 <= noise_ticks <= MOST_NOISE_TICKS:
        raise BadOption(f"--noise-ticks is between 0 and {MOST_NOISE_TICKS}")
    check_time_factor(time_factor)
    instance = load_instance(robot)
    arm = load_arm(instance.robot, instance.model, calibration)
    home = instance.robot.home_joints
    start = home if joints_deg is None else joints_from_degrees(joints_deg, count=len(home))
    bus = simulated_arm(arm, start, RobotClock(time_factor).now, seed, noise_ticks)
    for line in faults:
        apply_fault(bus, line)

    def announce(device: str) -> None:
        sys.stdout.write(f"{device}\n")
        sys.stdout.flush()
        tell(f"{len(bus.servos)} simulated servos; fault commands: {', '.join(FAULTS)}")

    def tell(line: str) -> None:
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()

    # A closed standard input is None here.
    commands = None if sys.stdin is None else sys.stdin.fileno()
    serve_bus(bus, announce=announce, complain=tell, commands=commands, link=link)
