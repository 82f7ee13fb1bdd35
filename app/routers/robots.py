"""Robots and their models."""

from typing import Any

from fastapi import APIRouter, Response
from pydantic import MISSING

from app.routers.dependencies import TheLinks
from app.routers.problem_answers import problem_answers
from app.schemas.robots import (
    JointAnswer,
    RobotAnswer,
    RobotsAnswer,
    RobotSummary,
    ToolAnswer,
)
from app.services.robots.instances import robot_instance
from hardware.servos.instances import RobotInstance, instance_names, load_instance
from solver import REVOLUTE, Joint, Robot, family_of

router = APIRouter(prefix="/v1/robots", tags=["robots"])


@router.get(
    "",
    operation_id="list_robots",
    summary="All robots",
    responses={200: {"model": RobotsAnswer}, **problem_answers(500)},
)
def list_robots() -> Response:
    """One robot a model, of the same name, and its simulated twin where it has servos."""
    robots = [_summary(load_instance(name)) for name in instance_names()]
    return _json(RobotsAnswer(robots=robots))


@router.get(
    "/{name}",
    operation_id="get_robot",
    summary="One robot: joints, limits, tools",
    responses={200: {"model": RobotAnswer}, **problem_answers(404, 500)},
)
def get_robot(name: str, links: TheLinks) -> Response:
    """Denavit-Hartenberg rows are classic; joint vectors are in this order of joints."""
    link = links.get(name)
    calibration = MISSING if link is None else list(link.hello.calibration_rad)
    return _json(_answer(robot_instance(name), calibration))


def _json(answer: RobotsAnswer | RobotAnswer) -> Response:
    return Response(answer.model_dump_json(), media_type="application/json")


def _summary(instance: RobotInstance) -> RobotSummary:
    robot = instance.robot
    return RobotSummary(
        name=robot.name,
        model=instance.model,
        simulated=instance.simulated,
        model_version=robot.version,
        description=robot.description,
        kinematics=_kinematics(robot),
        tools=[tool.name for tool in robot.tools],
    )


def _answer(instance: RobotInstance, calibration_rad: list[float] | MISSING) -> RobotAnswer:
    robot = instance.robot
    return RobotAnswer(
        name=robot.name,
        model=instance.model,
        simulated=instance.simulated,
        model_version=robot.version,
        description=robot.description,
        source=robot.source,
        kinematics=_kinematics(robot),
        joints=[_joint(joint) for joint in robot.joints],
        mount_position_m=list(robot.mount_position_m),
        mount_rpy_rad=list(robot.mount_rpy_rad),
        flange_roll_rad=robot.flange_roll_rad,
        mass_source=robot.mass_source or MISSING,
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
        home_joints=list(robot.home_joints),
        calibration_rad=calibration_rad,
    )


def _kinematics(robot: Robot) -> str:
    tool = robot.tool(robot.default_tool)
    assert tool is not None, "parse_robot checks it"
    return family_of(robot, tool).name


def _joint(joint: Joint) -> JointAnswer:
    turns = joint.kind == REVOLUTE
    names = (
        ("lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2")
        if turns
        else ("lower_m", "upper_m", "velocity_m_s", "acceleration_m_s2")
    )
    values = (joint.lower, joint.upper, joint.velocity, joint.acceleration)
    limits: dict[str, Any] = dict(zip(names, values, strict=True))
    return JointAnswer(
        name=joint.name,
        kind=joint.kind,
        a_m=joint.a_m,
        alpha_rad=joint.alpha_rad,
        d_m=joint.d_m,
        offset_rad=joint.offset_rad,
        mass_kg=MISSING if joint.link is None else joint.link.mass_kg,
        **limits,
    )
