"""What an approach costs a batch: its own effort, and the travel to the next target's posture."""

from collections.abc import Sequence
from dataclasses import dataclass

from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.problem.effort import posture_effort
from solver.problem.retreats import even_retreats
from solver.robots.model import Array


@dataclass(frozen=True)
class Coupling:
    """What an approach costs, with the travel to a next target where there is one.

    Attributes:
        task: the target's, seen from where its effort counts from.
        next_thinning: the next target's thinning posture, shape (joints,); None without one.
    """

    task: ApproachTask
    next_thinning: Sequence[float] | None

    def cost(self, candidate: Candidate) -> float:
        """The effort of thinning, and from standby to the next thinning posture."""
        if self.next_thinning is None:
            return candidate.effort
        task, ends = self.task, even_retreats(self.task.options, 2)
        standby = retreat_rows(
            task.robot, task.tool, candidate.thinning_joints, candidate.branch, ends
        )[0]
        return candidate.effort + self.onwards(standby)

    def onwards(self, standby: Array) -> float:
        """The effort from a standby posture, shape (joints,), to the next thinning posture."""
        if self.next_thinning is None:
            return 0.0
        task = self.task
        return posture_effort(self.next_thinning, standby, task.joint_weights, task.options.norm)
