"""From which posture each target's effort counts in a plan."""

from collections.abc import Iterator, Mapping
from typing import Any

from solver import Problem, Target


def planned_with_references(
    plan: Mapping[str, Any], problem: Problem
) -> Iterator[tuple[Mapping[str, Any], Target, list[float]]]:
    """Planned approaches in execution order, with their target and reference posture [rad]."""
    targets = {target.id: target for target in problem.targets}
    reference = list(plan["start_joints"])
    for approach in plan["approaches"]:
        if approach["status"] != "planned":
            continue
        yield approach, targets[approach["target_id"]], reference
        if plan["options"]["order"] != "independent":
            reference = approach["standby_joints"]
