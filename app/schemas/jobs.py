"""Bodies of jobs; `app.routers.jobs` makes the answers.

Clients must expect new fields and new values of every status.
"""

from pydantic import MISSING, BaseModel, Field

from app.schemas.answers import ApproachAnswer


class JobAnswer(BaseModel):
    """A large batch on its way: queued, running, and in the end completed, failed or canceled."""

    id: str = Field(description="also the id of its plan")
    plan_id: str = Field(description="GET /v1/plans/{plan_id} has it once the job is completed")
    robot: str = Field(description="whose plan it makes")
    status: str = Field(description="queued, running, completed, failed or canceled")
    targets: int = Field(description="how many the batch has")
    done: int = Field(description="how many of them are finished: planned and infeasible ones")
    planned: int = Field(description="how many have an approach")
    infeasible: int = Field(description="how many have none")
    created_at: str = Field(description="ISO 8601, UTC")
    started_at: str | MISSING = Field(default=MISSING, description="ISO 8601, UTC")
    ended_at: str | MISSING = Field(default=MISSING, description="ISO 8601, UTC")
    detail: str | MISSING = Field(default=MISSING, description="why it failed")


class JobsAnswer(BaseModel):
    """Jobs, newest first."""

    jobs: list[JobAnswer] = Field(description="newest first, 50 at most")


class JobResultsAnswer(BaseModel):
    """What is solved so far."""

    approaches: list[ApproachAnswer] = Field(description="in the order that they are solved in")
