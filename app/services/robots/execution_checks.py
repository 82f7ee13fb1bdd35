"""What is checked before an execution is taken on, and the refusals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import orjson

from app.services.exceptions import Conflict, NotFound, invalid_request
from app.services.plans.plan_reading import whole_answer
from app.services.robots.execution_record import Execution, targets_of_plan
from app.services.robots.instances import robot_instance
from app.services.robots.links import Link
from app.services.store_calls import store_call
from app.store import PlanStore
from hardware.link.messages import TargetAccount
from hardware.servos.instances import RobotInstance, load_instance
from solver import PLANNED, Fault, UnknownRobot

FAULT: Final = "fault"


@dataclass(frozen=True)
class OrderedPlan:
    """A plan that is to be executed: its JSON, and what of it is needed here."""

    id: str
    request: str
    answer: str
    tool: str
    model_version: str
    start_joints: tuple[float, ...]
    approaches: Sequence[Mapping[str, Any]]
    fits: bool

    def targets(self, at: str) -> tuple[TargetAccount, ...]:
        """The account of its targets before anything has moved."""
        return targets_of_plan(self.approaches, at)


async def ordered_plan(plans: PlanStore, plan_id: str, robot: str) -> OrderedPlan:
    """The plan that a robot is to execute.

    Raises:
        NotFound: no such plan or robot.
        InvalidRequest: no target of the plan can be approached.
    """
    return await store_call(_ordered_plan, plans, plan_id, robot)


def _ordered_plan(plans: PlanStore, plan_id: str, robot: str) -> OrderedPlan:
    stored = plans.plan(plan_id)
    if stored is None:
        raise NotFound("not_found", "There is no plan of this id.")
    instance = robot_instance(robot)
    text = whole_answer(plans, plan_id, stored)
    answer = orjson.loads(text)
    if not any(approach["status"] == PLANNED for approach in answer["approaches"]):
        raise invalid_request([Fault(("plan_id",), "the plan has no planned target")])
    return OrderedPlan(
        id=plan_id,
        request=stored.request,
        answer=text.decode(),
        tool=answer["tool"],
        model_version=answer["model_version"],
        start_joints=tuple(answer["start_joints"]),
        approaches=answer["approaches"],
        fits=_fits(answer, instance),
    )


def _fits(answer: Mapping[str, Any], instance: RobotInstance) -> bool:
    try:
        planned_for = load_instance(answer["robot"])
    except UnknownRobot:
        return False
    same_version = answer["model_version"] == instance.robot.version
    return planned_for.model == instance.model and same_version


def check_worker(plan: OrderedPlan, link: Link) -> None:
    """See to it that this worker can execute that plan now.

    Raises:
        Conflict: it cannot.
    """
    if link.telemetry is not None and link.telemetry.status == FAULT:
        detail = "The robot has a fault; somebody must look at it and acknowledge it first."
        raise Conflict("fault", detail)
    if not plan.fits:
        detail = "The plan was made for another model of robot, or for another version of it."
        raise Conflict("model_mismatch", detail)
    if link.hello.tool != plan.tool:
        detail = "The plan was made for another tool than the one that is mounted."
        raise Conflict("tool_mismatch", detail)


def execution_not_found() -> NotFound:
    """The refusal for an execution."""
    return NotFound("not_found", "There is no execution of this id.")


def wrong_state(execution: Execution, allowed: Sequence[str]) -> Conflict:
    """The refusal of a command that makes no sense now."""
    detail = f"The execution is {execution.status}; this needs one that is {' or '.join(allowed)}."
    return Conflict("wrong_state", detail)
