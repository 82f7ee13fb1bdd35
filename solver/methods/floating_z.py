"""`floating_z`: T 3.4.2. Evenly spaced approach angles, all branches, the least effort wins."""

from solver.approach.arcs.arcs import sample_angles, sample_angles_of
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import first_at_level
from solver.problem.solution import Reason


def solve_floating_z(task: ApproachTask, phase_rad: float = 0.0) -> Candidate | Reason:
    """The cheapest of `samples` approach angles whose whole cut-in is feasible.

    Ties go to the smaller angle, then to tool side 1, then to the lower branch number.

    Args:
        task: the target's task.
        phase_rad: turns all angles, phi_k = phase - pi + 2 pi k / n [rad]. T starts them at random;
            here they start at -pi unless a comparison asks for another start.
    """
    n = task.options.samples
    angles = sample_angles(n) + phase_rad
    offers: list[tuple[float, float, int, int, float]] = []
    for side in task.tool_sides:
        margins, efforts = sample_angles_of(task, side, angles)
        for branch, k in zip(*(margins >= 0).nonzero(), strict=True):
            angle = signed_angle(float(angles[k]))
            offers.append((float(efforts[branch, k]), abs(angle), -side, int(branch), angle))
    offers.sort()
    chosen = first_at_level(task, ((angle, -side, branch) for _, _, side, branch, angle in offers))
    if chosen is None:
        return diagnose(task, angles)
    cost, _, negative_side, branch, angle = offers[chosen]
    thinning = task.thinning_joints(angle, -negative_side, branch)
    return Candidate(angle, -negative_side, branch, thinning, cost, n, "best_of_samples")
