"""Bodies of comparisons and scenarios.

`app.reports.wire` and `app.services.comparisons` make the answers. Clients must expect new fields
and new values of every status and name.
"""

from typing import Annotated

from pydantic import MISSING, BaseModel, Field

from app.schemas.requests import StrictBody


class ComparisonRequest(StrictBody):
    """Which scenario to compare the methods on."""

    scenario: str = Field(description="a name of GET /v1/scenarios")
    methods: Annotated[list[str], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING, description="default: the scenario's own choice"
    )
    repeats: int | MISSING = Field(
        default=MISSING,
        description="timed calls of each method at each target, 1 to 1000; "
        "default: as many as fit into a minute, 25 at most",
    )


class ScenarioAnswer(BaseModel):
    """A scenario that methods can be compared on."""

    name: str
    title: str


class ScenariosAnswer(BaseModel):
    """All scenarios."""

    scenarios: list[ScenarioAnswer]


class SpreadAnswer(BaseModel):
    """Over targets; what falls on a failure is left out."""

    median: float | MISSING = MISSING
    q95: float | MISSING = MISSING
    max: float | MISSING = MISSING


class MethodSummaryAnswer(BaseModel):
    """One method over all targets; docs/comparisons.md tells what each field means."""

    method: str
    summary: str | MISSING = MISSING
    targets: int
    solved: int
    solved_share: float
    time_s: SpreadAnswer
    charged_time_s: float
    cold_time_s: SpreadAnswer | MISSING = MISSING
    cold_solved: int | MISSING = MISSING
    gap: SpreadAnswer
    increase_percent: SpreadAnswer | MISSING = MISSING
    not_compared: int
    time_reduction_percent: float | MISSING = MISSING
    published_time_s: float | MISSING = MISSING
    published_increase_percent: float | MISSING = MISSING
    published_time_reduction_percent: float | MISSING = MISSING
    smallest_margin: float | MISSING = MISSING
    iterations: SpreadAnswer | MISSING = MISSING
    largest_residuals: dict[str, float]
    largest_published_difference_percent: float | MISSING = MISSING


class ComparisonRowAnswer(BaseModel):
    """One method at one target; docs/comparisons.md tells what each field means."""

    target_id: str
    method: str
    solved: bool
    status: str
    time_s: float
    repeats: int
    detail: str | MISSING = MISSING
    index: float | MISSING = MISSING
    cold_time_s: float | MISSING = MISSING
    cold_repeats: int | MISSING = MISSING
    cold_solved: bool | MISSING = MISSING
    cold_index: float | MISSING = MISSING
    cold_detail: str | MISSING = MISSING
    iterations: int | MISSING = MISSING
    residuals: dict[str, float]
    margin: float | MISSING = MISSING
    joints: list[float] | MISSING = MISSING
    gap: float | MISSING = MISSING
    increase_percent: float | MISSING = MISSING
    time_reduction_percent: float | MISSING = MISSING
    published_index: float | MISSING = MISSING
    published_time_s: float | MISSING = MISSING
    published_difference_percent: float | MISSING = MISSING
    published_increase_percent: float | MISSING = MISSING
    published_time_reduction_percent: float | MISSING = MISSING


class MachineAnswer(BaseModel):
    """On what and with what it was measured."""

    processor: str
    cores: int
    memory_gib: float
    system: str
    python: str
    versions: dict[str, str]
    load_average: float = Field(description="at the start")
    date: str


class ComparisonResultAnswer(BaseModel):
    """A complete comparison: what `prunus compare --json` prints."""

    scenario: str
    title: str
    origin: str
    index_name: str
    notes: list[str]
    published_on: str | MISSING = MISSING
    reference: str
    seeds: list[int]
    machine: MachineAnswer
    repeats: int
    findings: list[str]
    rows: list[ComparisonRowAnswer]
    summaries: list[MethodSummaryAnswer]


class ComparisonProgressAnswer(BaseModel):
    """How far a running comparison is."""

    rows_done: int
    rows_total: int


class ComparisonAnswer(BaseModel):
    """A comparison: queued, running, and in the end completed or failed."""

    id: str
    scenario: str
    methods: list[str] | MISSING = Field(default=MISSING, description="as asked for")
    repeats: int | MISSING = Field(default=MISSING, description="as asked for")
    status: str
    created_at: str
    started_at: str | MISSING = MISSING
    ended_at: str | MISSING = MISSING
    progress: ComparisonProgressAnswer | MISSING = Field(
        default=MISSING, description="while it is running"
    )
    detail: str | MISSING = Field(default=MISSING, description="why it failed")
    result: ComparisonResultAnswer | MISSING = Field(
        default=MISSING, description="when it is completed"
    )
