"""Compiles the kernels and builds the programmes, so that the first request does not wait.

Run as `python -m solver.warm_up` at set-up; kernels stay compiled on disk.
"""

from dataclasses import replace

from solver.problem import Target
from solver.robots.model import Robot


def warm_up() -> None:
    """Solves one small problem by every method for each robot, and small batches."""
    from solver import Options, Problem, load_robot, robot_names, solve
    from solver.approach.numerical import numerical_warm_start
    from solver.approach.task import approach_task
    from solver.kinematics.families import has_closed_form
    from solver.registry import METHODS
    from solver.tolerances import EXACT_TARGETS

    for name in robot_names():
        robot = load_robot(name)
        target = home_target(robot)
        for method in METHODS:
            for norm in ("l1", "l2"):
                solve(Problem(robot, [target], options=Options(method=method, norm=norm)))
        problem = Problem(robot, [target])
        if not has_closed_form(robot, problem.mounted_tool):
            continue
        # What is refused, certified, uncertain or relaxed goes through kernels of its own.
        outside = (0.0, 0.0, 2 * robot.reach_m(problem.mounted_tool))
        several = [
            target,
            replace(target, id="refused", position_m=outside),
            replace(target, id="uncertain", position_std_m=1e-5),
        ]
        solve(Problem(robot, several, options=Options(method="ssas", certify=True)))
        relaxed = Options(strike_zone_m=0.01, tilt_tolerance_rad=0.1)
        solve(Problem(robot, several, options=relaxed))
        # No robot that ships needs the numerical inverse; one brought by somebody may.
        numerical_warm_start(approach_task(problem, target, problem.start))

    # Few targets are ordered by other kernels than many; robots share them.
    robot = load_robot("tabletop")
    for count in (2, EXACT_TARGETS + 1):
        targets = [replace(home_target(robot), id=str(k)) for k in range(count)]
        solve(Problem(robot, targets, options=Options(method="ssas", order="optimal")))


def home_target(robot: Robot) -> Target:
    """A target that fits every robot: where its tool is near home, with a branch across the tool.

    Near, because joints that need not move at all are not what a first request is like.
    """
    import numpy as np

    from solver.kinematics.forward import forward_kinematics

    tool = robot.tool(robot.default_tool)
    assert tool is not None, "parse_robot checks it"
    home, middle = np.array(robot.home_joints), (robot.lower + robot.upper) / 2
    towards = np.where(middle >= home, 1.0, -1.0)
    pose = forward_kinematics(robot, tool, home + 0.05 * towards * (robot.upper - robot.lower))
    position, across = pose[:3, 3].tolist(), pose[:3, 1].tolist()
    return Target("warm-up", position, across)


if __name__ == "__main__":
    warm_up()
