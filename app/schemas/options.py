"""A plan's options: each is described once, for requests and for answers.

Ranges, defaults and known values are the solver's own, so that none of them can become stale. They
are looked up when the OpenAPI document is made, so that importing a schema does not import the
solver with its compilers.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

from pydantic import MISSING, BaseModel, Field

TEXTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "method": "how each target is solved",
        "order": "what each target starts from: the start posture, or the previous planned "
        "standby, targets being in the order sent or in one that is chosen",
        "norm": "effort as the sum of weighted joint travel, or of its squares",
        "weights": "weight of each joint in the effort: 1 each, or from the arm's own torques",
        "joint_weights": "weight of each joint in the effort, in joint order; replaces `weights`",
        "standoff_m": "distance of standby behind the target [m]",
        "path_points": "rows of `path_joints`, both ends included",
        "straightness_m": "how far the executed cut-in may leave its line [m]",
        "dwell_s": "time at the target [s]",
        "limit_margin_rad": "kept from every limit of a revolute joint during the cut-in [rad]",
        "symmetric_tool": "whether the tool may be turned about its axis by half a turn",
        "strike_zone_m": "length of the forks along which the target may lie, at most "
        "`standoff_m` [m]; not with `certify`, above 0 with a closed form only",
        "tilt_tolerance_rad": "how far the tool's y axis may lean off the branch [rad]; not with "
        "`certify`, above 0 with a closed form only",
        "position_margin_m": "how far targets should be free to move, as far as some approach of "
        "the method allows [m]; above 0 with a closed form only",
        "samples": "how many approach angles `floating_z` tries",
        "seed": "of what is drawn: the search for an order, the starts of a numerical inverse",
        "certify": "whether a proven lower bound is added to each effort; with a closed form only",
        "nlp_backend": "what solves the programme of `ncos`",
        "qp_solver": "what solves the quadratic programmes of `sqp`",
        "include": "parts of the answer, `arcs` with a closed form only",
    }
)
"""By field of `solver.Options`; docs/options.md has more of each."""


def asked(name: str) -> Any:
    """The field of an option in a request, which may be left out.

    What is told here is not checked here: `solver.Problem` refuses values, with its own pointers.
    """
    return Field(default=MISSING, json_schema_extra=_late(_asked, name))


def answered(name: str, **given: Any) -> Any:
    """The field of an option in an answer."""
    return Field(json_schema_extra=_late(_answered, name), **given)


def _late(
    described: Callable[[str], Mapping[str, Any]], name: str
) -> Callable[[dict[str, Any]], None]:
    return lambda schema: schema.update(described(name))


def _asked(name: str) -> dict[str, Any]:
    from solver import (
        DEFAULT_POSITION_MARGIN_M,
        FULL_ANSWER,
        FULL_ANSWER_TARGETS,
        MOST_WEIGHT,
        RANGES,
        Options,
    )

    text = TEXTS[name]
    if name == "joint_weights":
        return {"description": f"{text}; each 0 to {MOST_WEIGHT:g}, not all 0"}
    if name == "include":
        return {
            "description": f"{text}; any of {', '.join(known_values()[name])} today; default: "
            f"{', '.join(FULL_ANSWER)} up to {FULL_ANSWER_TARGETS} targets, then path"
        }
    default = getattr(Options(), name)
    if name == "position_margin_m":
        default = DEFAULT_POSITION_MARGIN_M
    if name in known_values():
        known = ", ".join(known_values()[name])
        return {"description": f"{text}; one of {known} today; default {default}"}
    if name in RANGES:
        lowest, highest = RANGES[name]
        between = f"{_written(lowest)} to {_written(highest)}"
        return {
            "description": f"{text}; {between}; default {_written(default)}",
            "minimum": lowest,
            "maximum": highest,
        }
    return {"description": f"{text}; default {str(default).lower()}"}


def _answered(name: str) -> dict[str, Any]:
    text = TEXTS[name]
    if name in known_values():
        text = f"{text}: {', '.join(known_values()[name])}; more may come"
    return {"description": f"{text}; absent if not given" if name == "joint_weights" else text}


def known_values() -> Mapping[str, Sequence[str]]:
    """What the solver knows today, by the options that take names."""
    from solver import (
        BACKEND_NAMES,
        INCLUDES,
        METHOD_NAMES,
        NORMS,
        ORDERS,
        QP_SOLVER_NAMES,
        WEIGHTS,
    )

    return {
        "method": METHOD_NAMES,
        "order": ORDERS,
        "norm": NORMS,
        "weights": WEIGHTS,
        "nlp_backend": BACKEND_NAMES,
        "qp_solver": QP_SOLVER_NAMES,
        "include": INCLUDES,
    }


def _written(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:g}"


class ResolvedOptions(BaseModel):
    """The options with every default filled in."""

    method: str = answered("method")
    order: str = answered("order")
    norm: str = answered("norm")
    weights: str = answered("weights")
    joint_weights: list[float] | MISSING = answered("joint_weights", default=MISSING)
    standoff_m: float = answered("standoff_m")
    path_points: int = answered("path_points")
    straightness_m: float = answered("straightness_m")
    dwell_s: float = answered("dwell_s")
    limit_margin_rad: float = answered("limit_margin_rad")
    symmetric_tool: bool = answered("symmetric_tool")
    strike_zone_m: float = answered("strike_zone_m")
    tilt_tolerance_rad: float = answered("tilt_tolerance_rad")
    position_margin_m: float = answered("position_margin_m")
    samples: int = answered("samples")
    seed: int = answered("seed")
    certify: bool = answered("certify")
    nlp_backend: str = answered("nlp_backend")
    qp_solver: str = answered("qp_solver")
    include: list[str] = answered("include")
