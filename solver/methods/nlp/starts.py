"""Where a programme starts: a thinning posture, and the standby straight behind it."""

import math

import numpy as np

from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.task.relaxation import placement
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.methods.nlp.instance import Start
from solver.problem.retreats import even_retreats
from solver.robots.model import Array


def start_at(task: ApproachTask, tool_side: int, branch: int | None, thinning: Array) -> Start:
    """A start from a thinning posture, its standby straight behind it on its branch."""
    ends = even_retreats(task.options, 2)
    rows = retreat_rows(task.robot, task.tool, tuple(thinning), branch, ends)
    pose = forward_kinematics(task.robot, task.tool, rows[-1])
    seen = placement(task.frame, np.asarray(task.target.position_m), tool_side, pose)
    angle = seen.approach_angle_rad
    return Start(
        tool_side,
        angle,
        angle - math.pi,
        angle + math.pi,
        rows[::-1],
        ends[::-1],
        seen.strike_m,
        seen.swing_rad,
    )
