"""The motions of a stored plan, verified anew: messages ready to send. Runs in a solver process."""

from collections.abc import Mapping
from typing import Any

import orjson
from pydantic import ValidationError

from app.services.plans.wire import parse_stored_request, problem_from_wire
from app.services.robots.execution_record import PLAN_OUTDATED
from hardware.clock import timestamp
from hardware.link.messages import Failure, SegmentTimes, TargetMotion, encode
from solver import (
    PLANNED,
    Approach,
    ChosenApproach,
    InvalidProblem,
    Problem,
    RetimingFailed,
    retime,
)


def target_motions(request: str, answer: str, execution_id: str) -> tuple[str, ...] | Failure:
    """One encoded message a planned target, or why the plan cannot be executed any more.

    Args:
        request: what the plan answers, JSON.
        answer: the plan, JSON.
        execution_id: which execution the motions are for.
    """
    plan = orjson.loads(answer)
    chosen = [_chosen(entry) for entry in plan["approaches"] if entry["status"] == PLANNED]
    try:
        approaches = retime(_problem(orjson.loads(request), plan), chosen)
    except RetimingFailed as error:
        detail = f"an approach of the plan does not hold any more: it {error.detail}"
        return Failure(PLAN_OUTDATED, detail, timestamp())
    except (ValidationError, InvalidProblem):
        detail = "the plan's request is none that this version of the service takes"
        return Failure(PLAN_OUTDATED, detail, timestamp())
    return tuple(
        encode(_motion(approach, execution_id, index)) for index, approach in enumerate(approaches)
    )


def _problem(request: Mapping[str, Any], plan: Mapping[str, Any]) -> Problem:
    # As it was resolved then: a default may have changed since.
    resolved = {name: plan[name] for name in ("robot", "tool", "start_joints", "options")}
    return problem_from_wire(parse_stored_request(orjson.dumps({**request, **resolved})))


def _chosen(entry: Mapping[str, Any]) -> ChosenApproach:
    # An arm without a closed form has no branch, and what is absent is left out of a plan.
    values: dict[str, Any] = {name: entry.get(name) for name in ChosenApproach.__dataclass_fields__}
    return ChosenApproach(**values)


def _motion(approach: Approach, execution_id: str, index: int) -> TargetMotion:
    standby, thinning, trajectory = (
        approach.standby_joints,
        approach.thinning_joints,
        approach.trajectory,
    )
    assert standby is not None, "planned approaches have all three"
    assert thinning is not None, "planned approaches have all three"
    assert trajectory is not None, "planned approaches have all three"
    return TargetMotion(
        execution_id=execution_id,
        index=index,
        target_id=approach.target_id,
        standby_joints=tuple(standby.tolist()),
        thinning_joints=tuple(thinning.tolist()),
        times_s=tuple(trajectory.times_s.tolist()),
        joints=tuple(map(tuple, trajectory.joints.tolist())),
        segments=tuple(
            SegmentTimes(part.name, part.start_s, part.end_s) for part in trajectory.segments
        ),
    )
