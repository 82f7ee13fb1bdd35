import numpy as np

from solver import Options, Problem, Robot, Target
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.cut_in.cut_in import rate_room, retreat_rows
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task

# Found by the descent of a relaxed task, which used up all the room that the rows have.
DIPS_BESIDE_ITS_FIRST_ROW = (
    -0.07160782427654457, 1.7228759594743852, 0.10926039408602128,
    0.10407582301679763, 1.283889086465574, 7.713621774043525e-06,
)  # fmt: skip


def test_a_dip_too_narrow_for_a_parabola_is_found(tabletop: Robot) -> None:
    """The joint is fastest 0.3 mm behind the first row, where the rate is all but used up."""
    options = Options(strike_zone_m=0.01, tilt_tolerance_rad=0.22)
    target = Target("a", (-0.1337, 0.0002, 0.391), (-0.135, -1.437, 0.288))
    problem = Problem(tabletop, [target], options=options)
    task = approach_task(problem, target, problem.start)
    candidate = Candidate(1.22, 1, 4, DIPS_BESIDE_ITS_FIRST_ROW, 2.3, 0, "")

    def room(retreats: np.ndarray) -> np.ndarray:
        rows = retreat_rows(task.robot, task.tool, candidate.thinning_joints, 4, retreats)
        return rate_room(task.robot, task.tool, 4, rows)

    assert room(np.asarray(task.retreats_m)).min() >= -1e-12
    fine = np.linspace(options.standoff_m, 0.0, 4001)
    assert room(fine).min() < -5e-5
    retreat = broken_between(task, candidate)
    assert retreat is not None
    assert abs(retreat - fine[room(fine).argmin()]) < 1e-4
