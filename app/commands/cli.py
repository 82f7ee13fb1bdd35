"""The command `prunus`. Heavy modules are imported by the commands that need them."""

import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from app.commands.backup import backup
from app.commands.compare import compare
from app.commands.failing import fail
from app.commands.robot import robot_commands
from app.commands.settings import SettingsFile
from app.commands.settings import settings as settings_command
from app.commands.token import token_commands

cli = typer.Typer(
    name="prunus",
    help="Decides how a robot arm reaches for blossoms in a tree.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
cli.add_typer(robot_commands, name="robot")
cli.add_typer(token_commands, name="token")
cli.command()(compare)
cli.command(name="settings")(settings_command)
cli.command()(backup)


def main() -> None:
    """Entry point of the command."""
    cli()


def _show_version(wanted: bool) -> None:
    if wanted:
        from app.version import prunus_version

        typer.echo(prunus_version())
        raise typer.Exit


@cli.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show it.")
    ] = False,
) -> None:
    """Decides how a robot arm reaches for blossoms in a tree."""


@cli.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on [127.0.0.1].")] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port; 0 takes a free one [8000].")
    ] = None,
    data_dir: Annotated[
        Path | None, typer.Option(help="Folder of the database [prunus-data].")
    ] = None,
    settings: SettingsFile = None,
) -> None:
    """Start the service.

    What is not given is taken from PRUNUS_... in the environment, and then from the settings file.
    """
    from app.commands.settings import settings_or_fail
    from app.server.serving import CannotServe, run_service

    given: dict[str, Any] = {"host": host, "port": port, "data_dir": data_dir}
    resolved = settings_or_fail(settings, given)
    try:
        run_service(resolved)
    except CannotServe as error:
        fail(str(error), code=1)


@cli.command()
def plan(
    request_file: Annotated[
        Path, typer.Argument(metavar="REQUEST.json", help="The body of POST /v1/plans.")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Where the plan's JSON goes.")
    ] = None,
    degrees: Annotated[
        bool,
        typer.Option(
            "--degrees",
            help="start_joints in the request are in degrees. All other angles have their unit "
            "in their name and stay as they are; so does the answer.",
        ),
    ] = False,
) -> None:
    """Plan in this process, without a service, and print a table in degrees and centimetres.

    Exits with 0 when there is a plan, infeasible targets or not, and with 2 on a bad request.
    """
    from pydantic import ValidationError
    from rich.console import Console

    from app.schemas.faults import structural_faults
    from app.services.plans.planning import plan_request
    from solver import InvalidProblem, InvalidRobot

    try:
        answer, body = plan_request(request_file.read_bytes(), degrees=degrees)
        if output is not None:
            output.write_bytes(body + b"\n")
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")
    except ValidationError as error:
        fail(*(f"{fault.pointer}: {fault.detail}" for fault in structural_faults(error)))
    except InvalidProblem as error:
        fail(*(f"{fault.pointer}: {fault.detail}" for fault in error.faults))
    except InvalidRobot as error:
        fail(str(error))
    from app.commands.plan_table import print_plan

    print_plan(answer, Console())


@cli.command()
def demo(
    output: Annotated[Path, typer.Option(help="Where the pictures go.")] = Path("prunus-demo"),
) -> None:
    """Plan the thesis's data set 3 over HTTP, and draw it."""
    from app.commands.demo import run_demo

    raise typer.Exit(run_demo(output))


@cli.command()
def export_openapi(
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Where it goes; default: standard output.")
    ] = None,
) -> None:
    """Write the OpenAPI document."""
    import json

    from app.server.application import create_app
    from app.settings import Settings

    document = create_app(Settings()).openapi()
    text = json.dumps(document, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
    if output is None:
        sys.stdout.write(text)
        return
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")


@cli.command()
def worker(
    url: Annotated[str, typer.Option(help="The service's address.")],
    robot: Annotated[str, typer.Option(help="Which robot this is.")],
    port: Annotated[str, typer.Option(help="Serial device of its servos.")],
    token_file: Annotated[
        Path | None,
        typer.Option(help="File with the service's token; default: PRUNUS_TOKEN, or none."),
    ] = None,
    tool: Annotated[
        str | None, typer.Option(help="The mounted tool; default: the robot's default.")
    ] = None,
    end_effector: Annotated[str, typer.Option(help="none or simulated.")] = "none",
    end_effector_record: Annotated[
        Path | None, typer.Option(help="File for the simulated end-effector's changes.")
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option(help="Calibration file; default: the one that ships.")
    ] = None,
    data_dir: Annotated[Path, typer.Option(help="Folder of the journal.")] = Path("prunus-worker"),
    baud_rate: Annotated[int, typer.Option(help="Of the servo bus.")] = 1_000_000,
    time_factor: Annotated[
        float, typer.Option(help="How much faster time runs; simulated servos only.")
    ] = 1,
) -> None:
    """Drive the servos behind a device for the service: one worker an arm.

    Ends with 0 on SIGINT, SIGTERM and SIGHUP, leaving the arm holding; with 1 when it cannot work.
    """
    from app.version import prunus_version
    from hardware.exceptions import HardwareError
    from hardware.options import read_token
    from hardware.worker.program import WorkerOptions, run_worker
    from solver import SolverError

    try:
        options = WorkerOptions(
            url=url,
            robot=robot,
            port=port,
            tool=tool,
            end_effector=end_effector,
            end_effector_record=end_effector_record,
            calibration=calibration,
            data_dir=data_dir,
            baud_rate=baud_rate,
            time_factor=time_factor,
            version=prunus_version(),
            token=read_token(token_file, os.environ.get("PRUNUS_TOKEN", "")),
        )
        run_worker(options, lambda news: typer.echo(news, err=True))
    except (HardwareError, SolverError) as error:
        fail(str(error), code=1)
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}", code=1)


@cli.command()
def calibrate(
    robot: Annotated[str, typer.Option(help="Whose servos, by the robot's name.")],
    port: Annotated[str, typer.Option(help="Serial device of the servos.")],
    joints_deg: Annotated[
        str, typer.Option(help="Where the arm truly stands, measured by you: Q1,...,Q6.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Where the calibration goes.")],
    baud_rate: Annotated[int, typer.Option(help="Of the servo bus.")] = 1_000_000,
) -> None:
    """Read the servos at a posture that is known, and write the offsets to a calibration file.

    Nothing is written to a servo and nothing moves. Ends with 1 when it cannot be measured.
    """
    import math

    from hardware.arm.calibrating import calibrate_arm
    from hardware.exceptions import HardwareError
    from solver import SolverError

    try:
        offsets = calibrate_arm(robot, port, baud_rate, joints_deg, output)
    except (HardwareError, SolverError) as error:
        fail(str(error), code=1)
    except OSError as error:
        fail(f"{output}: {error.strerror}", code=1)
    for joint, offset in offsets.items():
        typer.echo(f"{joint} {math.degrees(offset):+.3f} deg")


@cli.command()
def servo_bus(
    robot: Annotated[str, typer.Option(help="Whose servos, by the robot's name.")] = "tabletop",
    joints_deg: Annotated[
        str | None,
        typer.Option(help="Where the arm stands at the start: Q1,...,Q6. Default: home."),
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option(help="Calibration file; default: the one that ships.")
    ] = None,
    link: Annotated[
        Path | None, typer.Option(help="Make a symbolic link to the device here.")
    ] = None,
    fault: Annotated[
        list[str] | None, typer.Option(help="A fault command to begin with; may be repeated.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of reading noise and corruption.")] = 0,
    noise_ticks: Annotated[
        int, typer.Option(help="Readings of a position are off by up to this.")
    ] = 1,
    time_factor: Annotated[float, typer.Option(help="How much faster the servos' time runs.")] = 1,
) -> None:
    """Simulate an arm's servos on a pseudo-terminal; the first line printed is its device.

    Standard input takes fault commands, one a line. Ends with 0 on SIGINT, SIGTERM and "unplug".
    """
    from hardware.exceptions import HardwareError
    from hardware.simulator.faults import FaultRefused
    from hardware.simulator.program import run_servo_bus
    from solver import SolverError

    try:
        run_servo_bus(
            robot=robot,
            joints_deg=joints_deg,
            calibration=calibration,
            link=link,
            faults=fault or (),
            seed=seed,
            noise_ticks=noise_ticks,
            time_factor=time_factor,
        )
    except (FaultRefused, HardwareError, SolverError) as error:
        fail(str(error))
