"""Answers of robots and their models; `app.routers.robots` makes them.

Clients must expect new fields and new values of every name.
"""

from pydantic import MISSING, BaseModel, Field

KINEMATICS = (
    "family of the arm with its default tool, by its inverse: `spherical_wrist` (closed form), "
    "`spherical_wrist_on_rail` (closed form wherever the rail stands), `general` (numerical)"
)


class JointAnswer(BaseModel):
    """A joint: its link's Denavit-Hartenberg row (classic convention) and its limits.

    The limits of a revolute joint are in radians, those of a prismatic joint in metres.
    """

    name: str = Field(description="the joint's name, once in a robot")
    kind: str = Field(description="revolute or prismatic")
    a_m: float = Field(description="the row's a: along the x axis of the next frame [m]")
    alpha_rad: float = Field(
        description="the row's alpha: about the x axis of the next frame [rad]"
    )
    d_m: float = Field(
        description="the row's d: along the joint's z axis; a prismatic joint's position "
        "is added [m]"
    )
    offset_rad: float = Field(
        description="the row's theta: about the joint's z axis; a revolute joint's "
        "position is added [rad]"
    )
    lower_rad: float | MISSING = Field(
        default=MISSING, description="lower limit of a revolute joint's position [rad]"
    )
    upper_rad: float | MISSING = Field(
        default=MISSING, description="upper limit of a revolute joint's position [rad]"
    )
    velocity_rad_s: float | MISSING = Field(
        default=MISSING, description="highest speed of a revolute joint, above 0 [rad/s]"
    )
    acceleration_rad_s2: float | MISSING = Field(
        default=MISSING, description="highest acceleration of a revolute joint, above 0 [rad/s2]"
    )
    lower_m: float | MISSING = Field(
        default=MISSING, description="lower limit of a prismatic joint's position [m]"
    )
    upper_m: float | MISSING = Field(
        default=MISSING, description="upper limit of a prismatic joint's position [m]"
    )
    velocity_m_s: float | MISSING = Field(
        default=MISSING, description="highest speed of a prismatic joint, above 0 [m/s]"
    )
    acceleration_m_s2: float | MISSING = Field(
        default=MISSING, description="highest acceleration of a prismatic joint, above 0 [m/s2]"
    )
    mass_kg: float | MISSING = Field(
        default=MISSING, description="of the link behind it; absent without masses [kg]"
    )


class ToolAnswer(BaseModel):
    """An end-effector, and how far the arm reaches with it at most."""

    name: str = Field(description="what requests call it")
    description: str = Field(description="a line for people")
    length_m: float = Field(
        description="from the last link to the tool centre point, along the last z axis [m]"
    )
    reach_m: float = Field(
        description="upper bound of the tool centre point's distance from the base origin [m]"
    )


class RobotSummary(BaseModel):
    """A robot in the list."""

    name: str = Field(description="what requests call it")
    model: str = Field(description="its model's name, which a simulated twin shares")
    simulated: bool = Field(description="whether only simulated servos may stand behind it")
    model_version: str = Field(description="digest of the model file")
    description: str = Field(description="a line for people")
    kinematics: str = Field(description=KINEMATICS)
    tools: list[str] = Field(description="names of its tools")


class RobotsAnswer(BaseModel):
    """All robots."""

    robots: list[RobotSummary] = Field(description="by name")


class RobotAnswer(BaseModel):
    """One robot in full."""

    name: str = Field(description="what requests call it")
    model: str = Field(description="its model's name, which a simulated twin shares")
    simulated: bool = Field(description="whether only simulated servos may stand behind it")
    model_version: str = Field(description="digest of the model file")
    description: str = Field(description="a line for people")
    source: str = Field(description="where the model's numbers are from")
    kinematics: str = Field(description=KINEMATICS)
    joints: list[JointAnswer] = Field(
        description="from the base on; every joint vector is in this order"
    )
    mount_position_m: list[float] = Field(
        description="three numbers: of the first joint's frame in the base frame [m]"
    )
    mount_rpy_rad: list[float] = Field(
        description="three angles of that frame: about the base frame's x, then y, then z [rad]"
    )
    flange_roll_rad: float = Field(description="a last turn about the last z axis [rad]")
    mass_source: str | MISSING = Field(
        default=MISSING, description="where the masses are from; absent without masses"
    )
    tools: list[ToolAnswer] = Field(description="what may be mounted, one at least")
    default_tool: str = Field(description="name of the tool of requests that name none")
    home_joints: list[float] = Field(
        description="start posture of requests that have none, in joint order [rad, or m for a "
        "prismatic joint]"
    )
    calibration_rad: list[float] | MISSING = Field(
        default=MISSING,
        description="offset of each joint's servo, in joint order [rad]; while a worker is "
        "connected",
    )
