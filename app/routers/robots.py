"""Robots and their models."""

from fastapi import APIRouter, Response

from app.errors import ProblemError
from app.routers.plans import problem_answers
from app.schemas.answers import (
    JointAnswer,
    RobotAnswer,
    RobotsAnswer,
    RobotSummary,
    ToolAnswer,
)
from solver import Robot, UnknownRobot, load_robot, robot_names

router = APIRouter(prefix="/v1/robots", tags=["robots"])


@router.get(
    "",
    operation_id="listRobots",
    summary="All robots",
    responses={200: {"model": RobotsAnswer}, **problem_answers(500)},
)
def list_robots() -> Response:
    """By default there is one robot a model, of the same name."""
    robots = [_summary(load_robot(name)) for name in robot_names()]
    return _json(RobotsAnswer(robots=robots))


@router.get(
    "/{name}",
    operation_id="getRobot",
    summary="One robot: joints, limits, tools",
    responses={200: {"model": RobotAnswer}, **problem_answers(404, 500)},
)
def get_robot(name: str) -> Response:
    """Denavit-Hartenberg rows are classic; joint vectors are in this order of joints."""
    try:
        robot = load_robot(name)
    except UnknownRobot:
        raise ProblemError(404, "not_found", "There is no robot of this name.") from None
    return _json(_answer(robot))


def _json(answer: RobotsAnswer | RobotAnswer) -> Response:
    return Response(answer.model_dump_json(), media_type="application/json")


def _summary(robot: Robot) -> RobotSummary:
    return RobotSummary(
        name=robot.name,
        model=robot.name,
        model_version=robot.version,
        description=robot.description,
        tools=[tool.name for tool in robot.tools],
    )


def _answer(robot: Robot) -> RobotAnswer:
    return RobotAnswer(
        name=robot.name,
        model=robot.name,
        model_version=robot.version,
        description=robot.description,
        source=robot.source,
        joints=[
            JointAnswer(
                name=joint.name,
                a_m=joint.a_m,
                alpha_rad=joint.alpha_rad,
                d_m=joint.d_m,
                offset_rad=joint.offset_rad,
                lower_rad=joint.lower_rad,
                upper_rad=joint.upper_rad,
                velocity_rad_s=joint.velocity_rad_s,
                acceleration_rad_s2=joint.acceleration_rad_s2,
            )
            for joint in robot.joints
        ],
        tools=[
            ToolAnswer(
                name=tool.name,
                description=tool.description,
                length_m=tool.length_m,
                reach_m=robot.reach_m(tool),
            )
            for tool in robot.tools
        ],
        default_tool=robot.default_tool,
        home_joints=list(robot.home_rad),
    )
