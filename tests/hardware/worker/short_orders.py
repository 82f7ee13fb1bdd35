"""Orders by hand, from home, of a second or two: no solver, and every number is known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from hardware.link.messages import Execute, SegmentTimes, TargetMotion
from hardware.worker.order import Order, build_order
from solver import Array, Robot, Tool
from tests.hardware.parts import Bench

STEP = np.array([0.02, -0.02, 0.03, 0.04, -0.02, 0.05])
"""From one stand-by posture to the next [rad]; inwards where a limit is near."""
CUT_IN = np.array([0.0, -0.03, 0.02, 0.0, -0.01, 0.0])
"""From a stand-by posture to the thinning posture [rad]."""

SEGMENTS = (("transfer", 0.0, 0.11), ("cut_in", 0.11, 0.2), ("dwell", 0.2, 0.35))
RETREAT_S = 0.05
TICKS = {"transfer": 6, "cut_in": 5, "retreat": 3}
"""Ticks of a segment at full pace: the last one is cut short."""


def standby(robot: Robot, index: int) -> Array:
    """Of the target with that index, from 0 [rad]."""
    return np.asarray(np.array(robot.home_joints) + (index + 1) * STEP)


def short_motion(robot: Robot, index: int, execution_id: str = "e1") -> TargetMotion:
    """A transfer in two rows and a half, a straight cut-in, a dwell, and back."""
    here = standby(robot, index)
    rows = (here - STEP, here - 0.4 * STEP, here, here + CUT_IN, here + CUT_IN, here)
    times = (0.0, 0.08, 0.11, 0.2, 0.35, 0.35 + RETREAT_S)
    segments = (*SEGMENTS, ("retreat", 0.35, 0.35 + RETREAT_S))
    return TargetMotion(
        execution_id=execution_id,
        index=index,
        target_id=f"t{index + 1}",
        standby_joints=tuple(here.tolist()),
        thinning_joints=tuple((here + CUT_IN).tolist()),
        times_s=times,
        joints=tuple(tuple(row.tolist()) for row in rows),
        segments=tuple(SegmentTimes(*segment) for segment in segments),
    )


def short_messages(
    robot: Robot, execution_id: str = "e1", targets: int = 2
) -> tuple[Execute, list[TargetMotion]]:
    """What the service sends for such an order."""
    execute = Execute(
        execution_id=execution_id,
        plan_id="p1",
        tool=robot.default_tool,
        model_version=robot.version,
        start_joints=robot.home_joints,
        target_count=targets,
    )
    return execute, [short_motion(robot, index, execution_id) for index in range(targets)]


def built(
    bench: Bench,
    mounted: Tool,
    *,
    targets: int = 2,
    motions: Sequence[TargetMotion] | None = None,
    changes: Mapping[str, object] = MappingProxyType({}),
) -> Order:
    """The order of these messages, or of others, or with other words in the first."""
    execute, own = short_messages(bench.robot, targets=targets)
    changed = replace(execute, **changes)  # type: ignore[arg-type]
    given = own if motions is None else motions
    return build_order(bench.robot, mounted, bench.map, changed, given)
