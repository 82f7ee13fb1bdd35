"""Robots as they are now, and what must work in every state: stop and acknowledge."""

from typing import Any

import orjson
from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from app.errors import ProblemError
from app.routers.dependencies import TheExecutions, TheLeases, TheLinks
from app.routers.problem_answers import problem_answers
from app.routers.requests import lease_of
from app.schemas.executions import AcknowledgeAnswer, RobotStateAnswer, StopAnswer
from app.schemas.present import present
from app.services.robots.instances import no_worker, robot_instance
from app.services.robots.links import ANSWER_S, Link, LinkService
from hardware.link.messages import Acknowledge, AcknowledgeReport, Stop, StopReport

router = APIRouter(prefix="/v1/robots/{name}", tags=["robots"])

NO_ANSWER = (
    f"The stop was sent, but the worker did not answer within {ANSWER_S:g} s: "
    "whether the arm has stopped is not known."
)


@router.get(
    "/state",
    operation_id="get_robot_state",
    summary="The robot as it is now",
    responses={200: {"model": RobotStateAnswer}, **problem_answers(404, 500)},
)
async def get_robot_state(name: str, links: TheLinks) -> Response:
    """As its worker described it last; without a worker nothing is known of it."""
    link = links.get(name)
    if link is not None:
        return _json(_state(link))
    instance = await run_in_threadpool(robot_instance, name)
    return _json(
        {
            "robot": name,
            "connected": False,
            "status": "disconnected",
            "simulated": instance.simulated,
        }
    )


@router.post(
    "/stop",
    operation_id="stop_robot",
    summary="Stop at once, whatever the robot does",
    responses={200: {"model": StopAnswer}, **problem_answers(404, 500, 503)},
)
async def stop_robot(name: str, links: TheLinks, executions: TheExecutions) -> Response:
    """Ahead of everything else, in every state. What has not begun yet will not begin.

    This is no emergency stop: it needs the service, the link and the worker. Cutting the power
    needs none of them.
    """
    link = await _link(name, links, "Nothing was stopped.")
    executions.withdraw(name)
    report = await link.ask(Stop)
    if not isinstance(report, StopReport):
        return _json({"stopped": False, "verified": False, "detail": NO_ANSWER})
    return _json(
        present(
            stopped=report.stopped,
            verified=report.verified,
            joints=report.joints,
            joints_read_at=report.joints_read_at,
            detail=report.detail,
        )
    )


@router.post(
    "/acknowledge",
    operation_id="acknowledge_faults",
    summary="A person has seen the faults",
    responses={200: {"model": AcknowledgeAnswer}, **problem_answers(404, 409, 500, 503)},
)
async def acknowledge_faults(
    name: str, request: Request, links: TheLinks, leases: TheLeases
) -> Response:
    """The worker checks again and clears what is gone; the answer has what is left."""
    leases.check(name, lease_of(request))
    link = await _link(name, links, "Nothing was acknowledged.")
    report = await link.ask(Acknowledge)
    if not isinstance(report, AcknowledgeReport):
        detail = f"The worker did not answer within {ANSWER_S:g} s."
        raise ProblemError(503, "no_answer", detail)
    return _json({"faults": report.faults})


async def _link(name: str, links: LinkService, consequence: str) -> Link:
    link = links.get(name)
    if link is None:
        await run_in_threadpool(robot_instance, name)
        raise no_worker(consequence)
    return link


def _state(link: Link) -> dict[str, Any]:
    hello, telemetry = link.hello, link.telemetry
    known = {
        "robot": link.robot,
        "connected": True,
        "simulated": hello.simulated,
        "tool": hello.tool,
        "end_effector": hello.end_effector,
        "device": hello.device,
    }
    if telemetry is None:
        return {**known, "status": "unknown"}
    return present(
        **known,
        status=telemetry.status,
        joints=telemetry.joints,
        joints_read_at=telemetry.joints_read_at,
        end_effector_state=telemetry.end_effector_state,
        torque=telemetry.torque,
        execution_id=telemetry.execution_id,
        faults=telemetry.faults,
        servos=telemetry.servos,
        overruns=telemetry.overruns,
        telemetry_age_s=link.telemetry_age_s,
    )


def _json(values: dict[str, Any]) -> Response:
    return Response(orjson.dumps(values), media_type="application/json")
