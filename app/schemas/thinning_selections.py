"""Bodies of thinning selections: blossoms along branches, and which of them go.

Structure and types only: what a value may be, `solver.problem.thinning` decides. Clients must
expect new fields in answers.
"""

from typing import Annotated

from pydantic import BaseModel, Field

from app.schemas.requests import Vector
from app.schemas.strict_body import StrictBody


class BlossomBody(StrictBody):
    """A blossom on a branch."""

    id: str = Field(
        description="not empty, once among all branches of the request",
        json_schema_extra={"minLength": 1},
    )
    distance_m: float = Field(
        description="along the branch from its origin, 0 to the branch's length [m]",
        json_schema_extra={"minimum": 0},
    )


class BlossomBranchBody(StrictBody):
    """A branch as a polyline from its origin to its tip."""

    id: str = Field(description="not empty, once in a request", json_schema_extra={"minLength": 1})
    points_m: Annotated[
        list[Vector],
        Field(
            fail_fast=True,
            description="two or more, three numbers each [m]; neighbours 1e-6 to 100 m apart. In "
            "the robot's base frame or another: the answer is in the same, which a plan of its "
            "targets must name",
            json_schema_extra={"minItems": 2},
        ),
    ]
    blossoms: Annotated[list[BlossomBody], Field(fail_fast=True, description="in any order")]


class ThinningSelectionRequest(StrictBody):
    """Branches with their blossoms."""

    branches: Annotated[list[BlossomBranchBody], Field(fail_fast=True)] = Field(
        description="at least one", json_schema_extra={"minItems": 1}
    )


class PlacedBlossomAnswer(BaseModel):
    """A blossom with its place in space."""

    id: str = Field(description="the blossom's")
    branch_id: str = Field(description="its branch's")
    position_m: list[float] = Field(
        description="three numbers: on the branch, in the same frame [m]"
    )
    branch_direction: list[float] = Field(
        description="three numbers of length 1: the tangent towards the tip"
    )
    distance_m: float = Field(description="along the branch from its origin, as sent [m]")


class ThinningSelectionAnswer(BaseModel):
    """Every blossom of the request, branch by branch as sent, from origin to tip."""

    targets: list[PlacedBlossomAnswer] = Field(description="what is removed, for a plan")
    keepers: list[PlacedBlossomAnswer] = Field(description="what stays")
