"""The commands `prunus robot ...`: arms in and out of other people's tools."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.failing import fail

robot_commands = typer.Typer(
    help="Arms in and out: URDF files and model files.", no_args_is_help=True
)


@robot_commands.command("export")
def export_robot(
    name: Annotated[str, typer.Argument(help="The robot's name.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Where the URDF goes.")],
    tool: Annotated[str | None, typer.Option(help="Its tool; default: the robot's own.")] = None,
) -> None:
    """Write a robot as a URDF file, with plain cylinders to look at."""
    from solver import SolverError, load_robot, robot_to_urdf

    try:
        robot = load_robot(name)
        mounted = robot.tool(tool or robot.default_tool)
        if mounted is None:
            fail(f"unknown tool; known: {', '.join(known.name for known in robot.tools)}")
        output.write_bytes(robot_to_urdf(robot, mounted))
    except SolverError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")


@robot_commands.command("import")
def import_robot(
    urdf: Annotated[Path, typer.Argument(metavar="ARM.urdf", help="The URDF file.")],
    base: Annotated[str, typer.Option(help="The link that stands in the base frame.")],
    tip: Annotated[
        str, typer.Option(help="The link in the tool frame: z along the forks, y along the branch.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Where the model file goes; names the robot.")
    ],
    acceleration_rad_s2: Annotated[
        float, typer.Option(min=0, help="Limit of the revolute joints; URDF has none.")
    ],
    acceleration_m_s2: Annotated[
        float, typer.Option(min=0, help="Limit of the prismatic joints; URDF has none.")
    ] = 1.0,
) -> None:
    """Turn a serial chain of a URDF file into a model file, and say what it can do."""
    from solver import SolverError, family_of, robot_from_urdf, robot_to_toml

    try:
        robot = robot_from_urdf(
            urdf.read_bytes(),
            base,
            tip,
            name=output.stem,
            acceleration_rad_s2=acceleration_rad_s2,
            acceleration_m_s2=acceleration_m_s2,
        )
        output.write_bytes(robot_to_toml(robot))
    except SolverError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")
    inverse = family_of(robot, robot.tools[0]).summary
    masses = "masses" if robot.has_masses else "no masses, so no torque weights"
    typer.echo(f"{robot.name}: {len(robot.joints)} joints, {inverse}, {masses}")
