"""A plan: the approaches of a batch, with the problem they answer."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from solver.problem.plain import number, plain_approach, plain_options
from solver.problem.problem import Problem
from solver.problem.solution import PLANNED, Approach


@dataclass(frozen=True, repr=False)
class Plan:
    """Approaches of a batch in execution order, with the problem they answer."""

    problem: Problem
    approaches: Sequence[Approach]
    elapsed_s: float

    @property
    def planned(self) -> int:
        """How many targets are planned."""
        return sum(approach.status == PLANNED for approach in self.approaches)

    @property
    def infeasible(self) -> int:
        """How many targets are not."""
        return len(self.approaches) - self.planned

    @property
    def total_effort(self) -> float:
        """Sum of the efforts of the planned targets."""
        return sum(approach.effort or 0.0 for approach in self.approaches)

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain values: what the service answers, without `id` and `version`.

        Raises:
            ValueError: a number of it is not finite.
        """
        problem, include = self.problem, frozenset(self.problem.options.include or ())
        sent_in = {}
        if (frame := problem.frame) is not None:
            sent_in = {"frame": frame.name, "frame_transform": frame.base_from_frame.to_dict()}
        return {
            "robot": problem.robot.name,
            "tool": problem.mounted_tool.name,
            **sent_in,
            "model_version": problem.robot.version,
            "start_joints": [number(value) for value in problem.start],
            "joint_weights": [number(value) for value in problem.joint_weights],
            "options": plain_options(problem.options),
            "approaches": [plain_approach(approach, include) for approach in self.approaches],
            "summary": {
                "planned": self.planned,
                "infeasible": self.infeasible,
                "total_effort": number(self.total_effort),
                "elapsed_s": number(self.elapsed_s),
            },
        }

    def to_json(self) -> str:
        """`to_dict` as JSON."""
        return json.dumps(self.to_dict())

    def __repr__(self) -> str:
        return (
            f"<Plan for {self.problem.robot.name}: {self.planned} planned, {self.infeasible} "
            f"infeasible, total effort {self.total_effort:.4g}>"
        )
