"""Targets in front of the arm that ships on a rail."""

from solver import Options, Problem, Target, load_robot
from solver.approach.task.task import ApproachTask, approach_task

ROBOT = load_robot("puma560_rail")


TARGETS = (
    Target("in front", (0.6, 0.1, 1.0), (0.0, 1.0, 0.2)),
    Target("only from the slide's end", (0.55, 1.25, 0.9), (1.0, 0.3, 0.0)),
    Target("nowhere", (3.0, 0.0, 0.9), (0.0, 0.0, 1.0)),
)


def task_of(target: Target, **options: object) -> ApproachTask:
    problem = Problem(ROBOT, TARGETS, options=Options(**options))  # type: ignore[arg-type]
    return approach_task(problem, target, (0.1, *ROBOT.home_joints[1:]))
