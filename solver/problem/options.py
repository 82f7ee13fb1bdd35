"""Options: how to solve, with names, ranges and defaults; docs/options.md tells what they mean."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from solver.problem.tolerances import LEAST_DWELL_S, LEAST_STRIKE_ZONE_M, LEAST_TILT_RAD

METHOD_NAMES: Final = ("fixed_z", "floating_z", "as", "ssas", "ncos")
BACKEND_NAMES: Final = ("sqp", "ipopt")
QP_SOLVER_NAMES: Final = ("daqp", "osqp", "piqp")
"""The rows of the registries in `solver.methods`, which stand above; a contract test compares."""

ORDERS: Final = ("independent", "given", "optimal")
NORMS: Final = ("l1", "l2")
WEIGHTS: Final = ("uniform", "torque")
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
    """How to solve; see docs/options.md for each field's meaning and range."""

    method: str = "ncos"
    order: str = "given"
    norm: str = "l1"
    weights: str = "uniform"
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
    nlp_backend: str = "sqp"
    qp_solver: str = "daqp"
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
