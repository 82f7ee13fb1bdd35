"""Honest answers, each with what it is judged by, and ways to spoil one thing of them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from solver import Approach, Options, Plan, Problem, Robot, Segment, Trajectory, load_robot, solve
from solver.approach.task.task import approach_task
from solver.kinematics.chain_rates import rates_behind
from solver.robots.model import Array
from tests.solver.kinematics.arms import ur5
from tests.solver.problems import data_set_3, random_targets, reachable_targets


@dataclass(frozen=True)
class Answer:
    """An approach, the problem that it answers, and the posture that it begins from."""

    problem: Problem
    approach: Approach
    reference: tuple[float, ...]

    @property
    def trajectory(self) -> Trajectory:
        assert self.approach.trajectory is not None
        return self.approach.trajectory


Spoil = Callable[[Answer], Answer]


def _first_of(plan: Plan) -> Answer:
    approach = next(one for one in plan.approaches if one.status == "planned")
    return Answer(plan.problem, approach, plan.problem.start)


@cache
def timed() -> Answer:
    return _first_of(solve(data_set_3(load_robot("tabletop"), method="ssas")))


@cache
def second() -> Answer:
    """One that begins from the standby posture of another, as does its problem."""
    plan = solve(data_set_3(load_robot("tabletop"), method="ssas"))
    before, own = plan.approaches[0].standby_joints, plan.approaches[1].standby_joints
    assert before is not None
    assert own is not None
    problem = replace(plan.problem, start_joints=tuple(own))
    return Answer(problem, plan.approaches[1], tuple(before))


@cache
def unhurried() -> Answer:
    """One with room below every velocity and acceleration."""
    return at_pace(timed(), transfer=2.0, cut_in=2.0, retreat=2.0)


@cache
def untimed() -> Answer:
    return _first_of(solve(data_set_3(load_robot("tabletop"), method="ssas", include=("path",))))


@cache
def without_level() -> Answer:
    return _first_of(solve(data_set_3(load_robot("tabletop"), position_margin_m=0.0)))


@cache
def certified() -> Answer:
    return _first_of(solve(data_set_3(load_robot("tabletop"), certify=True)))


@cache
def relaxed() -> Answer:
    options = Options(order="independent", strike_zone_m=0.02, tilt_tolerance_rad=0.15)
    targets = random_targets(seed=33, count=16)
    return _first_of(solve(Problem(load_robot("tabletop"), targets, options=options)))


@cache
def on_rail() -> Answer:
    rail = load_robot("puma560_rail")
    options = Options(method="ssas", order="independent", include=("path",))
    return _first_of(solve(Problem(rail, reachable_targets(rail, 5, 3), options=options)))


@cache
def without_branches() -> Answer:
    arm, options = ur5(), Options(order="independent", include=("path",))
    return _first_of(solve(Problem(arm, reachable_targets(arm, 5, 3), options=options)))


@cache
def too_fast() -> Answer:
    """A cut-in that is right but for a joint that swings round an all but straight wrist."""
    honest = untimed()
    problem = replace(honest.problem, targets=random_targets(seed=7, count=40))
    retreats = np.linspace(problem.options.standoff_m, 0.0, problem.options.path_points)
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        for branch in range(8):
            for angle in np.linspace(-3.0, 3.0, 25).tolist():
                rows = task.postures(angle, 1, branch, retreats)
                whole = np.isfinite(rows).all() and task.inside(rows).min() > 0.01
                if whole and 300 < rates_behind(task.robot, task.tool, rows).max() < 1000:
                    approach = replace(
                        honest.approach,
                        target_id=target.id,
                        approach_angle_rad=angle,
                        branch=branch,
                        thinning_joints=rows[-1],
                        standby_joints=rows[0],
                        path_joints=rows,
                    )
                    return Answer(problem, approach, problem.start)
    raise AssertionError("none of them is too fast")


def claim(**changes: Any) -> Spoil:
    """With other fields."""
    return lambda answer: replace(answer, approach=replace(answer.approach, **changes))


def more(field: str, amount: float, index: tuple[int, ...] = ()) -> Spoil:
    """With so much added to a field, or to one number of it."""

    def spoil(answer: Answer) -> Answer:
        value = np.array(getattr(answer.approach, field))
        value[index] += amount
        return claim(**{field: value if value.ndim else float(value)})(answer)

    return spoil


def asked(**changes: Any) -> Spoil:
    """As the answer to a problem with other options."""

    def spoil(answer: Answer) -> Answer:
        options = replace(answer.problem.options, **changes)
        return replace(answer, problem=replace(answer.problem, options=options))

    return spoil


def for_target(change: Callable[[Any], Any]) -> Spoil:
    """As the answer to a problem whose target is another."""

    def spoil(answer: Answer) -> Answer:
        own = answer.approach.target_id
        targets = [change(one) if one.id == own else one for one in answer.problem.targets]
        return replace(answer, problem=replace(answer.problem, targets=tuple(targets)))

    return spoil


def for_robot(change: Callable[[Robot], Robot]) -> Spoil:
    """As the answer of another arm."""
    return lambda answer: replace(
        answer, problem=replace(answer.problem, robot=change(answer.problem.robot))
    )


def moved(**changes: Any) -> Spoil:
    """With another trajectory."""

    def spoil(answer: Answer) -> Answer:
        return claim(trajectory=replace(answer.trajectory, **changes))(answer)

    return spoil


def row_moved(segment: str, share: float, amounts: dict[int, float]) -> Spoil:
    """With some joints moved in a row of the trajectory, so far into a segment [rad]."""

    def spoil(answer: Answer) -> Answer:
        joints = answer.trajectory.joints.copy()
        row = _row_at(answer, segment, share)
        for joint, amount in amounts.items():
            joints[row, joint] += amount
        return moved(joints=joints)(answer)

    return spoil


def rows_added(segment: str, share: float, after_s: tuple[float, ...], amount: float) -> Spoil:
    """With rows so long behind one of a segment that stand elsewhere by an amount in one joint."""

    def spoil(answer: Answer) -> Answer:
        row, times, joints = _row_at(answer, segment, share), *_arrays(answer)
        for k, later_s in enumerate(after_s, start=1):
            times = np.insert(times, row + k, times[row] + later_s)
            joints = np.insert(joints, row + k, joints[row], axis=0)
            joints[row + k, 0] += amount * (k % 2)
        return moved(times_s=times, joints=joints)(answer)

    return spoil


def begins_late(segment: str, amount: float) -> Spoil:
    """With a segment that begins behind its first row, at one moved by an amount in one joint."""
    late_s = 1e-3

    def spoil(answer: Answer) -> Answer:
        row, times, joints = _row_at(answer, segment, 0.0), *_arrays(answer)
        start = times[row]
        times = np.where(times > start, times + late_s, times)
        times = np.insert(times, row + 1, start + late_s)
        joints = np.insert(joints, row + 1, joints[row], axis=0)
        joints[row + 1, 0] += amount
        segments = []
        for one in answer.trajectory.segments:
            later = one.start_s > start
            # Between two rows: the one before ends at the first, this one begins at the second.
            begin = one.start_s + late_s * later + late_s / 2 * (one.name == segment)
            end = one.end_s + late_s * (one.end_s > start) + late_s / 2 * (one.end_s == start)
            segments.append(Segment(one.name, begin, end))
        return moved(times_s=times, joints=joints, segments=tuple(segments))(answer)

    return spoil


def emptied(segment: str) -> Spoil:
    """With a segment that begins and ends between two rows, and the next one in its place."""

    def spoil(answer: Answer) -> Answer:
        own, *_ = (one for one in answer.trajectory.segments if one.name == segment)
        between = own.start_s + 1e-6
        names = [one.name for one in answer.trajectory.segments]
        segments = [
            Segment(
                one.name,
                between if names.index(one.name) == names.index(segment) + 1 else one.start_s,
                between if one.end_s == own.start_s else one.end_s,
            )
            for one in answer.trajectory.segments
            if one.name != segment
        ]
        segments.insert(names.index(segment), Segment(segment, between, between))
        return moved(segments=tuple(segments))(answer)

    return spoil


def at_pace(answer: Answer, **factors: float) -> Answer:
    """With segments that take so many times as long."""
    times = answer.trajectory.times_s
    new, segments, now = np.zeros_like(times), [], 0.0
    for one in answer.trajectory.segments:
        factor = factors.get(one.name, 1.0)
        inside = (times >= one.start_s) & (times <= one.end_s)
        new[inside] = now + factor * (times[inside] - one.start_s)
        end = float(new[inside][-1])
        segments.append(Segment(one.name, now, end))
        now = end
    return moved(times_s=new, segments=tuple(segments))(answer)


def limited(quantity: str, segment: str) -> Spoil:
    """As the answer of an arm that is a little too weak for one segment, the others slowed."""

    def spoil(answer: Answer) -> Answer:
        others = {one.name: 4.0 for one in answer.trajectory.segments if one.name != segment}
        slowed = at_pace(answer, **{**others, "dwell": 1.0})
        own, *_ = (one for one in slowed.trajectory.segments if one.name == segment)
        times, joints = _arrays(slowed)
        inside = (times >= own.start_s) & (times <= own.end_s)
        steps = np.diff(times[inside])[:, None]
        speeds = np.diff(joints[inside], axis=0) / steps
        if quantity == "acceleration":
            speeds = np.concatenate(
                (np.diff(speeds, axis=0) / steps[1:], 2 * speeds[:1] / steps[:1])
            )
        limits = np.array([getattr(joint, quantity) for joint in slowed.problem.robot.joints])
        share = 0.98 * float(np.max(np.abs(speeds) / limits))

        def weaker(robot: Robot) -> Robot:
            own = [
                replace(joint, **{quantity: share * getattr(joint, quantity)})
                for joint in robot.joints
            ]
            return replace(robot, joints=tuple(own))

        return for_robot(weaker)(slowed)

    return spoil


def _arrays(answer: Answer) -> tuple[Array, Array]:
    return answer.trajectory.times_s, answer.trajectory.joints


def _row_at(answer: Answer, segment: str, share: float) -> int:
    own, *_ = (one for one in answer.trajectory.segments if one.name == segment)
    wanted = own.start_s + share * (own.end_s - own.start_s)
    return int(np.abs(answer.trajectory.times_s - wanted).argmin())
