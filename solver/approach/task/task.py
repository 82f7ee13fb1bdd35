"""One target's task definition: what every method is given."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from solver.approach.task.feasibility import CutInTask, trace
from solver.approach.task.frame import ApproachFrame, approach_frame
from solver.approach.task.packed import PackedTask, jump_cosines, pack
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem.options import Options
from solver.problem.problem import Problem
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc
from solver.problem.targets import Target
from solver.robots.model import Array, Robot, Tool
from solver.robots.rigid import inverse


@dataclass(frozen=True)
class ApproachTask:
    """A target, the posture that effort counts from, and the rows of the cut-in that must hold.

    Attributes:
        retreats_m: distances behind the target at which the cut-in has to be feasible, from the
            standoff down to 0 [m].
    """

    robot: Robot
    tool: Tool
    options: Options
    target: Target
    reference: tuple[float, ...]
    joint_weights: tuple[float, ...]
    retreats_m: tuple[float, ...]

    @cached_property
    def frame(self) -> ApproachFrame:
        """The target's approach frame."""
        return approach_frame(self.target.position_m, self.target.branch_direction)

    @property
    def tool_sides(self) -> tuple[int, ...]:
        """Sides that the tool may take: 1, and -1 too when it is symmetric."""
        return (1, -1) if self.options.symmetric_tool else (1,)

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper limits less the margin asked for, shape (joints,) each [rad or m]."""
        return self.robot.limits_within(self.options.limit_margin_rad)

    @property
    def lower(self) -> Array:
        """Lower limits less the margin asked for, shape (joints,) [rad or m]."""
        return self.limits[0]

    @property
    def upper(self) -> Array:
        """Upper limits less the margin asked for, shape (joints,) [rad or m]."""
        return self.limits[1]

    def inside(self, rows: Array) -> Array:
        """Distance of each joint to its nearer limit, rows (..., joints) as they are [rad or m]."""
        return np.minimum(rows - self.lower, self.upper - rows)

    def for_kernels(self, tool_side: int) -> CutInTask:
        """The task as the kernels take it, with the tool on one side, in the mount's frame."""
        return self._for_kernels[tool_side]

    @cached_property
    def _for_kernels(self) -> dict[int, CutInTask]:
        return {side: self._kernel_task(side) for side in self.tool_sides}

    def _kernel_task(self, tool_side: int) -> CutInTask:
        position, y_axis, outward, sideways = self._vectors(tool_side)
        return CutInTask(
            geometry=wrist_geometry(self.robot, self.tool),
            lower=self.lower,
            upper=self.upper,
            position=position,
            y_axis=y_axis,
            outward=outward,
            sideways=sideways,
            retreats=np.asarray(self.retreats_m),
            reference=np.asarray(self.reference),
            weights=np.asarray(self.joint_weights),
            squared=self.options.squared,
        )

    def _vectors(self, tool_side: int) -> tuple[Array, Array, Array, Array]:
        """Target, y axis, approach directions at 0 and at a quarter turn, in the mount's frame."""
        mount, frame = inverse(self.robot.mount), self.frame
        turn = mount[:3, :3]
        position = turn @ np.asarray(self.target.position_m, dtype=np.float64) + mount[:3, 3]
        y_axis = turn @ (tool_side * frame.branch)
        return position, y_axis, turn @ frame.outward, turn @ frame.sideways

    def packed(self, tool_side: int) -> PackedTask:
        """The task as the inner loops take it, with the tool on one side, in the mount's frame."""
        return self._packed[tool_side]

    def packed_arcs(self, arcs: Sequence[Arc]) -> tuple[Array, ...]:
        """The task by tool side, shape (sides, NUMBERS), with some of its arcs, for the kernels.

        Behind the numbers: retreats and steps of a `PackedTask`, and of each arc the place of its
        tool side, its branch, and its lower and upper angle [rad], shape (n,) each.
        """
        first = self.packed(self.tool_sides[0])
        return (
            self.numbers_by_side,
            first.retreats,
            first.cos_steps,
            np.array([self.tool_sides.index(arc.tool_side) for arc in arcs], dtype=np.int64),
            np.array([arc.branch for arc in arcs], dtype=np.int64),
            np.array([arc.lower_rad for arc in arcs]),
            np.array([arc.upper_rad for arc in arcs]),
        )

    @property
    def numbers_by_side(self) -> Array:
        """The packed task's numbers by tool side, shape (sides, NUMBERS)."""
        return np.stack([self.packed(side).numbers for side in self.tool_sides])

    @cached_property
    def _packed(self) -> dict[int, PackedTask]:
        return {side: self._pack(side) for side in self.tool_sides}

    def _pack(self, tool_side: int) -> PackedTask:
        position, y_axis, outward, sideways = self._vectors(tool_side)
        numbers = pack(
            wrist_geometry(self.robot, self.tool),
            self.limits,
            (position[None], y_axis[None], outward[None], sideways[None]),
            np.asarray(self.reference),
            np.asarray(self.joint_weights),
            self.options.squared,
        )
        return PackedTask(numbers[0], np.asarray(self.retreats_m), jump_cosines(self.retreats_m))

    def postures(self, angle: float, tool_side: int, branch: int, retreats: Array) -> Array:
        """Closed-form postures of the cut-in, shape (len(retreats), 6) [rad]; retreats end at 0."""
        rows = np.empty((len(retreats), 6))
        trace(self.for_kernels(tool_side), angle, branch, np.ascontiguousarray(retreats), rows)
        return rows

    def thinning_joints(self, angle: float, tool_side: int, branch: int) -> tuple[float, ...]:
        """The closed-form posture at the target [rad]."""
        # With its whole cut-in, which decides the turn of joints that can turn further than once.
        row = self.postures(angle, tool_side, branch, np.asarray(self.retreats_m))[-1]
        return tuple(float(value) for value in row)

    def with_retreat(self, retreat: float) -> "ApproachTask":
        """The same task with one more row at which the cut-in has to be feasible."""
        return replace(self, retreats_m=tuple(sorted({*self.retreats_m, retreat}, reverse=True)))


def approach_task(problem: Problem, target: Target, reference: Sequence[float]) -> ApproachTask:
    """The task of one target of a problem, seen from a reference posture [rad]."""
    return approach_tasks(problem, (target,), reference)[0]


def approach_tasks(
    problem: Problem, targets: Sequence[Target], reference: Sequence[float]
) -> list[ApproachTask]:
    """The tasks of some targets of a problem, all seen from a reference posture [rad]."""
    seen_from = tuple(float(value) for value in reference)
    retreats_m = tuple(looked_at_retreats(problem.options).tolist())
    return [
        ApproachTask(
            robot=problem.robot,
            tool=problem.mounted_tool,
            options=problem.options,
            target=target,
            reference=seen_from,
            joint_weights=problem.joint_weights,
            retreats_m=retreats_m,
        )
        for target in targets
    ]
