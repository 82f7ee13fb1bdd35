"""`prunus worker`: puts a worker together from its options, and runs it until a signal ends it."""

import logging
import signal
import sys
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from hardware.arm.servo_arm import ServoArm
from hardware.arm.setup_check import is_simulated
from hardware.bus.dynamixel_bus import DynamixelBus
from hardware.clock import RobotClock
from hardware.end_effector.end_effectors import END_EFFECTORS
from hardware.exceptions import HardwareError
from hardware.link.messages import Hello
from hardware.link.worker_end import RobotLink, link_url
from hardware.options import BadOption, check_time_factor
from hardware.servos.instances import RobotInstance, load_instance
from hardware.servos.joints import load_arm
from hardware.worker.journal import Journal
from hardware.worker.worker import Worker
from solver import Tool


class NotSimulated(HardwareError):
    """Something that is for simulated servos only, on real ones."""

    code = "not_simulated"


@dataclass(frozen=True)
class WorkerOptions:
    """What the command line says.

    Attributes:
        url: the service's http or https address.
        robot: a robot's name, see `hardware.servos.instances`.
        port: the serial device.
        tool: the mounted tool; None: the robot's default.
        end_effector: a name in `hardware.end_effector.end_effectors.END_EFFECTORS`.
        end_effector_record: file for the simulated end-effector's changes.
        calibration: a calibration file; None: the one that ships.
        data_dir: folder of the journal.
        baud_rate: of the bus [1/s].
        time_factor: how many times faster than the wall clock; simulated servos only.
        version: this program's, for the service.
        token: the service's; empty: none. It is never shown.
    """

    url: str
    robot: str
    port: str
    tool: str | None
    end_effector: str
    end_effector_record: Path | None
    calibration: Path | None
    data_dir: Path
    baud_rate: int
    time_factor: float
    version: str
    token: str = field(default="", repr=False)


def run_worker(options: WorkerOptions, say: Callable[[str], None]) -> None:
    """Run a worker until SIGINT, SIGTERM or SIGHUP; the arm is left holding.

    Args:
        options: see there.
        say: called with a sentence for the operator.

    Raises:
        UnknownRobot: no robot of that name.
        HardwareError: it cannot start, or the service will not have it.
        OSError: the journal cannot be kept.
    """
    _check_options(options)
    logging.basicConfig(stream=sys.stderr, format="%(levelname)s %(message)s")
    instance = load_instance(options.robot)
    tool = _tool(instance, options.tool)
    arm_map = load_arm(instance.robot, instance.model, options.calibration)
    clock = RobotClock(options.time_factor)
    with ExitStack() as closing:
        bus = DynamixelBus(options.port, options.baud_rate)
        closing.callback(bus.close)
        arm = ServoArm(instance.robot, arm_map, bus, clock)
        simulated = _check_simulated(options, instance, arm)
        journal = Journal(options.data_dir / f"{instance.name}.journal")
        end_effector = END_EFFECTORS[options.end_effector](options.end_effector_record)
        closing.callback(end_effector.close)
        hello = Hello(
            robot=instance.name,
            model_version=instance.robot.version,
            tool=tool.name,
            end_effector=options.end_effector,
            device=bus.device,
            simulated=simulated,
            calibration_rad=arm_map.calibration_rad,
            version=options.version,
        )
        link = RobotLink(link_url(options.url, instance.name), hello, say, options.token)
        worker = Worker(arm, tool, end_effector, link, journal, clock)
        # A terminal that is closed ends a worker as properly as ctrl-C does.
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: worker.end())
        worker.run()
        say(f"ended; torque is {arm.torque}" + (": the arm holds" if arm.torque == "on" else ""))


def _check_options(options: WorkerOptions) -> None:
    if options.end_effector not in END_EFFECTORS:
        known = ", ".join(END_EFFECTORS)
        raise BadOption(f"--end-effector {options.end_effector} is unknown; known: {known}")
    check_time_factor(options.time_factor)


def _tool(instance: RobotInstance, name: str | None) -> Tool:
    tool = instance.robot.tool(name or instance.robot.default_tool)
    if tool is None:
        known = ", ".join(tool.name for tool in instance.robot.tools)
        raise BadOption(f"--tool {name} is unknown; known: {known}")
    return tool


def _check_simulated(options: WorkerOptions, instance: RobotInstance, arm: ServoArm) -> bool:
    simulated = is_simulated(arm.chain)
    if instance.simulated and not simulated:
        raise NotSimulated(f"{instance.name} is simulated; not all servos on {options.port} are")
    if options.time_factor != 1 and not simulated:
        raise NotSimulated("only simulated servos can run faster than the clock")
    return simulated
