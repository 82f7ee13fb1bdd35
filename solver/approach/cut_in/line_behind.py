"""The straight line behind a thinning posture: postures on it, and how far it is within reach."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.approach.task.feasibility import retreat_from, retreat_reach
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.numerical import postures_behind
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.robots.model import Array, Robot, Tool
from solver.robots.rigid import inverse


@dataclass(frozen=True)
class LineBehind:
    """The cut-in of an approach, for any retreats.

    Attributes:
        robot: the arm, or the rail with it, which stands still.
        tool: its tool.
        thinning: the posture at the target, shape (joints,) [rad or m].
        branch: the inverse kinematics branch, on a rail that of the arm; None for an arm without a
            closed form, where each row follows from its neighbour.
    """

    robot: Robot
    tool: Tool
    thinning: Sequence[float] | Array
    branch: int | None

    def rows(self, retreats: Array) -> Array:
        """Postures on the branch, with the orientation of thinning, shape (rows, joints).

        Without turns between rows; the last row is `thinning` itself.

        Args:
            retreats: distances behind the target, descending to 0, shape (rows,) [m].
        """
        posture = np.asarray(self.thinning, dtype=np.float64)
        retreats = np.ascontiguousarray(retreats)
        if self.branch is None:
            return postures_behind(self.robot, self.tool, posture, retreats)
        rows = np.empty((len(retreats), len(posture)))
        rows[:, :-6] = posture[:-6]
        joints = np.empty((len(retreats), 6))
        joints[-1] = posture[-6:]
        geometry = wrist_geometry(self._arm, self.tool)
        retreat_from(geometry, self._pose, self.branch, retreats, joints)
        rows[:, -6:] = joints
        return rows

    def reach(self, retreats: Array) -> Array:
        """How far the wrist centre is inside the reach at each retreat, shape (n,) [m].

        Infinite for an arm without a closed form, whose postures miss the line where they do not
        reach.
        """
        retreats = np.ascontiguousarray(retreats)
        margins = np.full(len(retreats), np.inf)
        if self.branch is not None:
            geometry = wrist_geometry(self._arm, self.tool)
            retreat_reach(geometry, self._pose, self.branch, retreats, margins)
        return margins

    @cached_property
    def _arm(self) -> Robot:
        family = family_of(self.robot, self.tool)
        standing = family.standing(self.robot, np.asarray(self.thinning))
        assert standing is not None, "it has branches"
        return standing.arm

    @cached_property
    def _pose(self) -> Array:
        posture = np.asarray(self.thinning, dtype=np.float64)
        pose = forward_kinematics(self.robot, self.tool, posture)
        return np.ascontiguousarray(inverse(self._arm.mount) @ pose)
