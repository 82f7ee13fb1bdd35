"""Plans and their parts as plain values: dicts, lists, texts and numbers, with the wire's names.

What is absent is left out; nothing is ever None.
"""

import math
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.options import Options
from solver.problem.solution import Approach, Arc, Nearest, Reason, Trajectory, Transfer


def plain_options(options: Options) -> dict[str, Any]:
    """Options, those that have no value left out."""
    values = {entry.name: getattr(options, entry.name) for entry in fields(options)}
    return {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in _present(**values).items()
    }


def plain_approach(approach: Approach, include: frozenset[str]) -> dict[str, Any]:
    """An approach; rows, motion and arcs only where they are asked for.

    Raises:
        ValueError: a number of it is not finite.
    """
    path = approach.path_joints if "path" in include else None
    transfer = approach.transfer if "transfer" in include else None
    trajectory = approach.trajectory if "trajectory" in include else None
    arcs = approach.arcs if "arcs" in include else None
    solver = approach.solver
    return _present(
        target_id=approach.target_id,
        status=approach.status,
        approach_angle_rad=_optional(approach.approach_angle_rad),
        tool_side=None if approach.tool_side is None else int(approach.tool_side),
        branch=None if approach.branch is None else int(approach.branch),
        strike_m=_optional(approach.strike_m),
        tilt_rad=_optional(approach.tilt_rad),
        thinning_joints=_numbers(approach.thinning_joints),
        standby_joints=_numbers(approach.standby_joints),
        path_joints=_numbers(path),
        path_deviation_m=_optional(approach.path_deviation_m),
        effort=_optional(approach.effort),
        lower_bound=_optional(approach.lower_bound),
        margin_rad=_optional(approach.margin_rad),
        displacement_margin_m=_optional(approach.displacement_margin_m),
        position_margin_m=_optional(approach.position_margin_m),
        margin_short=approach.margin_short,
        solver={
            "method": solver.method,
            "elapsed_s": number(solver.elapsed_s),
            "iterations": int(solver.iterations),
            "status": solver.status,
        },
        transfer=None if transfer is None else _transfer(transfer),
        trajectory=None if trajectory is None else _trajectory(trajectory),
        reason=None if approach.reason is None else _reason(approach.reason),
        arcs=None if arcs is None else [_arc(arc) for arc in arcs],
    )


def _arc(arc: Arc) -> dict[str, Any]:
    return _present(
        tool_side=int(arc.tool_side),
        branch=int(arc.branch),
        lower_rad=number(arc.lower_rad),
        upper_rad=number(arc.upper_rad),
        lower_limit=arc.lower_limit,
        upper_limit=arc.upper_limit,
    )


def _reason(reason: Reason) -> dict[str, Any]:
    return _present(
        code=reason.code,
        joint=reason.joint,
        detail=reason.detail,
        margin_rad=_optional(reason.margin_rad),
        margin_m=_optional(reason.margin_m),
        proven=reason.proven,
        nearest=None if reason.nearest is None else _nearest(reason.nearest),
    )


def _nearest(nearest: Nearest) -> dict[str, Any]:
    return {
        "kind": nearest.kind,
        "approach_angle_rad": number(nearest.approach_angle_rad),
        "displacement_m": [number(value) for value in nearest.displacement_m],
        "verified": bool(nearest.verified),
    }


def _transfer(transfer: Transfer) -> dict[str, Any]:
    return {
        "planner": transfer.planner,
        "joints": _numbers(transfer.joints),
        "length_rad": number(transfer.length_rad),
    }


def _trajectory(trajectory: Trajectory) -> dict[str, Any]:
    return {
        "times_s": _numbers(trajectory.times_s),
        "joints": _numbers(trajectory.joints),
        "segments": [
            {"name": part.name, "start_s": number(part.start_s), "end_s": number(part.end_s)}
            for part in trajectory.segments
        ],
    }


def number(value: float) -> float:
    """A number of Python's own.

    Raises:
        ValueError: it is not finite: JSON has no NaN and no infinity.
    """
    if not math.isfinite(value):
        raise ValueError("a plan has a number that is not finite")
    return float(value)


def _optional(value: float | None) -> float | None:
    return None if value is None else number(value)


def _numbers(values: NDArray[np.float64] | None) -> list[Any] | None:
    if values is None:
        return None
    if not np.isfinite(values).all():
        raise ValueError("a plan has a number that is not finite")
    rows: list[Any] = np.asarray(values, dtype=np.float64).tolist()
    return rows


def _present(**values: Any) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}
