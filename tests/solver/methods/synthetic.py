"""One target of data set 3 as methods see it, small enough for kernels that are interpreted."""

from solver import Problem, load_robot
from solver.approach.task.task import ApproachTask, approach_task
from tests.solver.problems import DATA_SET_3, data_set_3

ROBOT = load_robot("tabletop")


def problem_of(**options: object) -> Problem:
    """Without a margin that has to be borne, unless one is asked for."""
    return data_set_3(ROBOT, **{"position_margin_m": 0.0, **options})


def small_task(index: int = 0, /, **options: object) -> ApproachTask:
    """One of the targets, seen from where the arm starts."""
    problem = problem_of(**options)
    return approach_task(problem, DATA_SET_3[index], problem.start)
