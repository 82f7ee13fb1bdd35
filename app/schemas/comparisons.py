"""Bodies of comparisons and scenarios; `app.services.comparisons.service` makes the answers.

Clients must expect new fields and new values of every status and name.
"""

from typing import Annotated

from pydantic import MISSING, BaseModel, Field

from app.schemas.comparison_results import ComparisonResultAnswer
from app.schemas.strict_body import StrictBody


class ComparisonRequest(StrictBody):
    """Which scenario to compare the methods on."""

    scenario: str = Field(description="a name of GET /v1/scenarios")
    methods: Annotated[list[str], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING,
        description="names of methods of the scenario, at least one; default: its own choice",
        json_schema_extra={"minItems": 1},
    )
    repeats: int | MISSING = Field(
        default=MISSING,
        description="timed calls of each method at each target, 1 to 1000; "
        "default: as many as fit into a minute, 25 at most",
        json_schema_extra={"minimum": 1, "maximum": 1000},
    )


class ScenarioAnswer(BaseModel):
    """A scenario that methods can be compared on."""

    name: str = Field(description="what requests call it")
    title: str = Field(description="a line for people")


class ScenariosAnswer(BaseModel):
    """All scenarios."""

    scenarios: list[ScenarioAnswer] = Field(description="docs/scenarios.md has more of each")


class ComparisonProgressAnswer(BaseModel):
    """How far a running comparison is."""

    rows_done: int = Field(description="how many pairs of a method and a target are measured")
    rows_total: int = Field(description="how many there are")


class ComparisonAnswer(BaseModel):
    """A comparison: queued, running, and in the end completed or failed."""

    id: str = Field(description="the comparison's id")
    scenario: str = Field(description="the scenario's name")
    methods: list[str] | MISSING = Field(default=MISSING, description="as asked for")
    repeats: int | MISSING = Field(default=MISSING, description="as asked for, 1 to 1000")
    status: str = Field(description="queued, running, completed or failed; more may come")
    created_at: str = Field(description="when it was taken on, RFC 3339 in UTC")
    started_at: str | MISSING = Field(
        default=MISSING, description="when it began to run, RFC 3339 in UTC; absent before"
    )
    ended_at: str | MISSING = Field(
        default=MISSING, description="when it ended, RFC 3339 in UTC; absent before"
    )
    progress: ComparisonProgressAnswer | MISSING = Field(
        default=MISSING, description="while it is running, from its first row on"
    )
    detail: str | MISSING = Field(default=MISSING, description="why it failed")
    result: ComparisonResultAnswer | MISSING = Field(
        default=MISSING, description="when it is completed"
    )
