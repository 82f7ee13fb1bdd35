"""Compiles the kernels and builds the programmes, so that the first request does not wait.

Run as `python -m solver.warm_up` at set-up; kernels stay compiled on disk.
"""

import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor, wait
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from solver import compiled
from solver.approach.arcs.of_problem import arcs_of_packed
from solver.approach.numerical.warm_start import numerical_warm_starts
from solver.approach.task.packing import packed_problem
from solver.approach.task.task import approach_task
from solver.kinematics.forward import forward_kinematics
from solver.methods.registry import METHODS
from solver.problem.options import MethodName, Options
from solver.problem.problem import Problem
from solver.problem.targets import Target
from solver.robots.files import load_robot, robot_names
from solver.robots.model import Robot
from solver.sequencing.gather import gather
from solver.sequencing.ordering import coarse_nodes, searched_order
from solver.sequencing.tolerances import ANNEAL_STEP_RAD
from solver.solving.solve import solve

ROBOT: Final = "tabletop"
"""Whose kernels are all robots': what differs between robots is numbers, but for the programmes."""

TELL_S: Final = 10.0
"""How often it is told how far the compilation is [s]: people give up on a minute of silence."""


def warm_up() -> None:
    """Everything, in this process."""
    for part in PARTS:
        PARTS[part]()


def methods() -> None:
    """One small problem by every method; for the other robots the one whose programme is theirs."""
    for name in robot_names():
        robot = load_robot(name)
        wanted: Iterable[MethodName] = METHODS if name == ROBOT else ("ncos",)
        for method in wanted:
            solve(Problem(robot, [home_target(robot)], Options(method=method)))


def refusals_and_bounds() -> None:
    """What is refused, certified, uncertain or untimed goes through kernels of its own."""
    robot = load_robot(ROBOT)
    several, options = _several(robot), Options(method="ssas", order="independent")
    solve(Problem(robot, several, options=replace(options, certify=True)))
    solve(Problem(robot, several, options=replace(options, include=("path",))))


def relaxations() -> None:
    """So does what is relaxed."""
    robot = load_robot(ROBOT)
    options = Options(order="independent", strike_zone_m=0.01, tilt_tolerance_rad=0.1)
    planned, refused, _ = _several(robot)
    solve(Problem(robot, [planned, refused], options=options))


def _several(robot: Robot) -> list[Target]:
    target = home_target(robot)
    return [
        target,
        replace(target, id="refused", position_m=(0.0, 0.0, 1.0)),
        replace(target, id="uncertain", position_std_m=1e-5),
    ]


def orders() -> None:
    """Few targets are ordered by other kernels than many, whose long search is not made here."""
    robot = load_robot(ROBOT)
    targets = [replace(home_target(robot), id=str(k)) for k in range(3)]
    problem = Problem(robot, targets, options=Options(method="ssas", order="optimal"))
    solve(problem)
    numbers = packed_problem(problem)
    arcs = arcs_of_packed(problem, numbers)
    batch = gather(problem, numbers, [arcs[target.id] for target in targets])
    searched_order(coarse_nodes(batch, ANNEAL_STEP_RAD), len(targets), 0, trials_a_target=1)


def other_arms() -> None:
    """No robot that ships needs the numerical inverse; one brought by somebody may."""
    robot = load_robot(ROBOT)
    problem = Problem(robot, [home_target(robot)])
    numerical_warm_starts(approach_task(problem, problem.targets[0], problem.start), most=1)


PARTS: Final[Mapping[str, Callable[[], None]]] = {
    "refusals_and_bounds": refusals_and_bounds,
    "orders": orders,
    "methods": methods,
    "other_arms": other_arms,
    "relaxations": relaxations,
}


def compile_on_both_cores() -> None:
    """Every part in a process of its own, two at a time: compilation uses one core.

    Tells on standard output how far it is.
    """
    began, before = time.monotonic(), compiled_kernels()
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(max_workers=2, mp_context=context) as pool:
        working = {pool.submit(_run, part) for part in PARTS}
        while working:
            done, working = wait(working, timeout=TELL_S)
            for part in done:
                part.result()
            count, elapsed_s = compiled_kernels() - before, time.monotonic() - began
            sys.stdout.write(f"   {count} kernels compiled in {elapsed_s:.0f} s\n")
            sys.stdout.flush()


def compiled_kernels() -> int:
    """How many kernels are kept on disk, each as often as it was compiled for other arguments."""
    folder = os.environ.get("NUMBA_CACHE_DIR") or compiled.cache_folder()
    return len(list(Path(folder).rglob("*.nbc")))


def _run(part: str) -> None:
    PARTS[part]()


def home_target(robot: Robot) -> Target:
    """A target that fits every robot: where its tool is near home, with a branch across the tool.

    Near, because joints that need not move at all are not what a first request is like.
    """
    tool = robot.tool(robot.default_tool)
    assert tool is not None, "parse_robot checks it"
    home, middle = np.array(robot.home_joints), (robot.lower + robot.upper) / 2
    towards = np.where(middle >= home, 1.0, -1.0)
    pose = forward_kinematics(robot, tool, home + 0.05 * towards * (robot.upper - robot.lower))
    position, across = pose[:3, 3].tolist(), pose[:3, 1].tolist()
    return Target("warm-up", position, across)


if __name__ == "__main__":
    compile_on_both_cores()
