"""Options: how to solve, with names, ranges and defaults; docs/options.md tells what they mean."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, get_args

from solver.problem.tolerances import LEAST_DWELL_S, LEAST_STRIKE_ZONE_M, LEAST_TILT_RAD

MethodName = Literal["fixed_z", "floating_z", "as", "ssas", "ncos"]
BackendName = Literal["sqp", "ipopt"]
QpSolverName = Literal["daqp", "osqp", "piqp"]
"""The rows of the registries in `solver.methods`, which stand above; a contract test compares."""

Order = Literal["independent", "given", "optimal"]
Norm = Literal["l1", "l2"]
Weights = Literal["uniform", "torque"]
METHOD_NAMES: Final[tuple[MethodName, ...]] = get_args(MethodName)
BACKEND_NAMES: Final[tuple[BackendName, ...]] = get_args(BackendName)
QP_SOLVER_NAMES: Final[tuple[QpSolverName, ...]] = get_args(QpSolverName)
ORDERS: Final[tuple[Order, ...]] = get_args(Order)
NORMS: Final[tuple[Norm, ...]] = get_args(Norm)
WEIGHTS: Final[tuple[Weights, ...]] = get_args(Weights)
FULL_ANSWER: Final = ("path", "transfer", "trajectory")
INCLUDES: Final = (*FULL_ANSWER, "arcs")
FULL_ANSWER_TARGETS: Final = 50
MOST_WEIGHT: Final = 1e6
DEFAULT_POSITION_MARGIN_M: Final = 0.001
"""With a closed form; without one it is 0."""

# Ranges outside which an option makes no sense: (lowest, highest), both allowed.
RANGES: Final[dict[str, tuple[float, float]]] = {
    "standoff_m": (0.001, 1.0),
    "path_points": (2, 200),
    "straightness_m": (1e-6, 0.01),
    "dwell_s": (0.0, 3600.0),
    "limit_margin_rad": (0.0, 0.5),
    "samples": (1, 10_000),
    "seed": (0, 2**63 - 1),
    "strike_zone_m": (0.0, 0.5),
    "tilt_tolerance_rad": (0.0, 0.8),
    "position_margin_m": (0.0, 0.05),
}


@dataclass(frozen=True)
class Options:
    """How to solve; docs/options.md has the ranges.

    Attributes:
        method: how a target's approach is found; `ncos` starts from what `ssas` finds.
        order: whether effort counts for each target from the start posture ("independent") or from
            the previous standby, in the order given or in one that is chosen.
        norm: effort is the sum of the weighted joint travel ("l1") or of its squares ("l2").
        weights: of the joints in the effort: all one, or from the arm's own torques.
        joint_weights: replace `weights`, one a joint.
        standoff_m: how far standby is behind the target.
        path_points: how many rows of the cut-in are answered, both ends included.
        straightness_m: how far the executed cut-in may leave its line.
        dwell_s: time at the target.
        limit_margin_rad: kept from every limit of a joint that turns during the cut-in.
        symmetric_tool: the tool may be turned half about its axis.
        strike_zone_m: length of the forks along which the target may lie.
        tilt_tolerance_rad: how far the tool's y axis may lean off the branch.
        position_margin_m: how far a target should be free to move, as far as some approach allows;
            None is DEFAULT_POSITION_MARGIN_M with a closed form and 0 without.
        samples: approach angles of `floating_z`.
        seed: of what is drawn.
        certify: efforts get a proven lower bound.
        nlp_backend: what solves the programme of `ncos`.
        qp_solver: what solves the quadratic programmes of "sqp".
        include: parts of the answer; None is all of FULL_ANSWER for up to FULL_ANSWER_TARGETS
            targets, else the path.
    """

    method: MethodName = "ncos"
    order: Order = "given"
    norm: Norm = "l1"
    weights: Weights = "uniform"
    joint_weights: Sequence[float] | None = None
    standoff_m: float = 0.04
    path_points: int = 20
    straightness_m: float = 1e-4
    dwell_s: float = 5.0
    limit_margin_rad: float = 0.005
    symmetric_tool: bool = False
    strike_zone_m: float = 0.0
    tilt_tolerance_rad: float = 0.0
    position_margin_m: float | None = None
    samples: int = 50
    seed: int = 0
    certify: bool = False
    nlp_backend: BackendName = "sqp"
    qp_solver: QpSolverName = "daqp"
    include: Sequence[str] | None = None

    @property
    def squared(self) -> bool:
        """Whether joint travel counts squared: the norm is l2."""
        return self.norm == "l2"

    @property
    def dwells(self) -> bool:
        """Whether the dwell is long enough to be one."""
        return self.dwell_s > LEAST_DWELL_S

    @property
    def strikes(self) -> bool:
        """Whether the strike zone is long enough to be one."""
        return self.strike_zone_m > LEAST_STRIKE_ZONE_M

    @property
    def tilts(self) -> bool:
        """Whether the tilt tolerance is wide enough to be one."""
        return self.tilt_tolerance_rad > LEAST_TILT_RAD

    @property
    def relaxed(self) -> bool:
        """Whether a relaxation is on that only the programme has."""
        return self.strikes or self.tilts

    @property
    def timed(self) -> bool:
        """Whether motion is part of the answer; by default it is, up to FULL_ANSWER_TARGETS."""
        return self.include is None or not {"transfer", "trajectory"}.isdisjoint(self.include)
