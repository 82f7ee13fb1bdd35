"""Bodies of jobs; `app.routers.jobs` makes the answers.

Clients must expect new fields and new values of every status.
"""

from pydantic import MISSING, BaseModel, Field

from app.schemas.answers import ApproachAnswer


class JobAnswer(BaseModel):
    """A large batch on its way: queued, running, and in the end completed, failed or canceled."""

    id: str = Field(description="also the id of its plan")
    plan_id: str = Field(description="GET /v1/plans/{plan_id} has it once the job is completed")
    robot: str = Field(description="the robot whose plan it makes, by name")
    status: str = Field(description="queued, running, completed, failed or canceled; more may come")
    targets: int = Field(description="how many the batch has")
    done: int = Field(description="how many of them are finished: planned and infeasible ones")
    planned: int = Field(description="how many have an approach")
    infeasible: int = Field(description="how many have none")
    created_at: str = Field(description="when it was taken on, RFC 3339 in UTC")
    started_at: str | MISSING = Field(
        default=MISSING, description="when it first began, RFC 3339 in UTC; absent before"
    )
    ended_at: str | MISSING = Field(
        default=MISSING, description="when it ended, RFC 3339 in UTC; absent before"
    )
    detail: str | MISSING = Field(default=MISSING, description="why it failed")


class JobsAnswer(BaseModel):
    """Jobs, newest first."""

    jobs: list[JobAnswer] = Field(description="newest first, 50 at most")


class JobResultsAnswer(BaseModel):
    """What is solved so far."""

    approaches: list[ApproachAnswer] = Field(description="in the order that they are solved in")
