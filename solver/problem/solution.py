"""What is answered for a target: an approach, planned or infeasible with a reason.

Rows of joint vectors are arrays of shape (rows, joints) [rad]; times in s, lengths in m.
"""

from dataclasses import dataclass
from typing import Final

from solver.robots.model import Array

PLANNED: Final = "planned"
INFEASIBLE: Final = "infeasible"

REASON_CODES: Final = (
    "out_of_reach",
    "joint_limit",
    "standby_infeasible",
    "cut_in_infeasible",
    "method_not_applicable",
    "solver_failed",
)


@dataclass(frozen=True)
class Arc:
    """Approach angles, lower to upper [rad], at which one branch is feasible in the whole cut-in.

    Attributes:
        tool_side: 1 or -1.
        branch: 0 to 7.
        lower_rad: in [-pi, pi].
        upper_rad: beyond pi where the arc crosses the half turn.
        lower_limit: what ends the arc there: a joint's name, "reach", "wrist_jump", or the
            target's "uncertainty"; None where the arc is the whole turn.
        upper_limit: the same at the upper end.
    """

    tool_side: int
    branch: int
    lower_rad: float
    upper_rad: float
    lower_limit: str | None = None
    upper_limit: str | None = None


@dataclass(frozen=True)
class SolverReport:
    """What a method did for one target."""

    method: str
    elapsed_s: float
    iterations: int
    status: str


@dataclass(frozen=True)
class Nearest:
    """The nearest feasible change to a target that has no approach.

    Attributes:
        kind: "angle": the method's other approach angles are feasible, this one is nearest to
            those it tried. "displacement": the target itself would have to move.
        approach_angle_rad: a feasible approach angle, in (-pi, pi]; with a displacement, in the
            approach frame of the displaced target.
        displacement_m: what is added to the target's position, shape (3,) [m]; zero for an angle.
        verified: the change was made and the whole cut-in found feasible.
    """

    kind: str
    approach_angle_rad: float
    displacement_m: tuple[float, float, float]
    verified: bool


@dataclass(frozen=True)
class Reason:
    """Why a target has no approach.

    Attributes:
        code: one of REASON_CODES.
        detail: a sentence for people.
        joint: the limiting joint's name, if a joint limits.
        margin_rad: how far that joint is inside its limits at best; negative: beyond [rad].
        proven: with `certify`, whether branch and bound has proven that no approach is feasible.
        margin_m: how far the wrist centre is inside the reach at best, or, where only the target's
            uncertainty is too large, by how much it may move less than it has to; negative [m].
        nearest: the nearest feasible change, if one was found.
    """

    code: str
    detail: str
    joint: str | None = None
    margin_rad: float | None = None
    margin_m: float | None = None
    proven: bool | None = None
    nearest: Nearest | None = None


@dataclass(frozen=True)
class Transfer:
    """Motion from the previous standby (or the start) to this target's standby.

    Attributes:
        planner: how it was found.
        joints: its corner postures, shape (rows, joints) [rad].
        length_rad: sum of the Euclidean lengths of its pieces in the space of the revolute joints
            [rad].
    """

    planner: str
    joints: Array
    length_rad: float


@dataclass(frozen=True)
class Segment:
    """A named part of a trajectory; the row at its end is the first of the next."""

    name: str
    start_s: float
    end_s: float


@dataclass(frozen=True)
class Trajectory:
    """Timed motion for one target: transfer, cut_in, dwell, retreat; joint-linear between rows.

    Attributes:
        times_s: shape (rows,), from 0, strictly increasing.
        joints: shape (rows, joints) [rad].
        segments: in order, without gaps.
    """

    times_s: Array
    joints: Array
    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class Approach:
    """The answer for one target. Only `solver.verification.verify` makes one that is planned.

    With status "infeasible" only `target_id`, `reason`, `solver` and `arcs` are set.

    Attributes:
        approach_angle_rad: angle of the approach direction about the branch, in (-pi, pi].
        tool_side: 1, or -1 when a symmetric tool is turned about its axis by half a turn.
        branch: number of the inverse kinematics branch, 0 to 7, on a rail that of the arm; None for
            an arm without a closed form.
        path_joints: the cut-in, shape (path_points, joints): standby first, thinning last [rad].
        path_deviation_m: largest distance of the tool centre point from the straight line in the
            motion as executed, between its rows too.
        strike_m: how far the tool centre point is beyond the target along z at thinning, when the
            problem has a strike zone.
        tilt_rad: angle between the tool's y axis and the branch, when the problem tolerates one.
        effort: weighted joint travel from the previous standby (or the start) to thinning.
        lower_bound: with `certify`, proven: no feasible approach of the unrelaxed task has an
            effort below it.
        margin_rad: smallest distance of a joint to its limit in the whole cut-in.
        displacement_margin_m: how far the target may move, in any direction, until a row of the
            path meets a limit, with its orientation and branch kept; limits less the margin asked
            for, the reach, and the straight wrist.
        position_margin_m: the largest part of the option's margin that some approach of the method
            bears; this one does.
        margin_short: True where that is less than the whole of it.
        arcs: if asked for, the feasible arcs of the task without relaxations; may be empty.
    """

    target_id: str
    status: str
    solver: SolverReport
    reason: Reason | None = None
    approach_angle_rad: float | None = None
    tool_side: int | None = None
    branch: int | None = None
    strike_m: float | None = None
    tilt_rad: float | None = None
    thinning_joints: Array | None = None
    standby_joints: Array | None = None
    path_joints: Array | None = None
    path_deviation_m: float | None = None
    effort: float | None = None
    lower_bound: float | None = None
    margin_rad: float | None = None
    displacement_margin_m: float | None = None
    position_margin_m: float | None = None
    margin_short: bool | None = None
    transfer: Transfer | None = None
    trajectory: Trajectory | None = None
    arcs: tuple[Arc, ...] | None = None
