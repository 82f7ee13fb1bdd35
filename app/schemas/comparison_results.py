"""What a comparison found; docs/comparisons.md has more of each field.

`app.reports.json_values` makes it.
Clients must expect new fields and new values of every status and name.
"""

from pydantic import MISSING, BaseModel, Field


class SpreadAnswer(BaseModel):
    """Over targets, in the unit of the field; what falls on a failure is left out."""

    median: float | MISSING = Field(
        default=MISSING, description="the middle value, in the unit of the field"
    )
    q95: float | MISSING = Field(
        default=MISSING, description="95 % are not above it, linear between values, in that unit"
    )
    max: float | MISSING = Field(default=MISSING, description="the largest value, in that unit")


class MethodSummaryAnswer(BaseModel):
    """One method over all targets."""

    method: str = Field(description="the method's name in the comparison")
    summary: str | MISSING = Field(default=MISSING, description="a line for people")
    targets: int = Field(description="how many there are")
    solved: int = Field(description="how many of them have an answer that the verifier accepts")
    solved_share: float = Field(description="solved over targets, 0 to 1")
    time_s: SpreadAnswer = Field(
        description="spread of `time_s` over all targets, failures with the time they took [s]"
    )
    charged_time_s: float = Field(
        description="mean time, each failure charged 10 times the longest time of any method at "
        "any target [s]"
    )
    cold_time_s: SpreadAnswer | MISSING = Field(
        default=MISSING,
        description="spread of `cold_time_s` [s]; absent where the method has no cold start",
    )
    cold_solved: int | MISSING = Field(
        default=MISSING, description="how many cold starts have an answer that is accepted"
    )
    gap: SpreadAnswer = Field(
        description="spread of `gap`, a share; failures rank behind every answer"
    )
    increase_percent: SpreadAnswer | MISSING = Field(
        default=MISSING,
        description="spread of `increase_percent` over the targets that the reference solves [%]; "
        "failures rank behind every answer",
    )
    not_compared: int = Field(description="how many targets the reference does not solve")
    time_reduction_percent: float | MISSING = Field(
        default=MISSING,
        description="median of `time_reduction_percent` over the targets that both solve [%]",
    )
    published_time_s: float | MISSING = Field(
        default=MISSING, description="median of the document's times [s]"
    )
    published_increase_percent: float | MISSING = Field(
        default=MISSING, description="median of the document's increases [%]"
    )
    published_time_reduction_percent: float | MISSING = Field(
        default=MISSING, description="median of the document's time reductions [%]"
    )
    smallest_margin: float | MISSING = Field(
        default=MISSING,
        description="smallest `margin` of the answers that hold [rad, or m where that joint "
        "slides]",
    )
    iterations: SpreadAnswer | MISSING = Field(
        default=MISSING, description="spread of `iterations`; absent where the method tells none"
    )
    largest_residuals: dict[str, float] = Field(
        description="largest of the answers that hold, by residual; a name ends in its unit, if "
        "there is one"
    )
    largest_published_difference_percent: float | MISSING = Field(
        default=MISSING,
        description="largest `published_difference_percent` in absolute value [%]",
    )


class ComparisonRowAnswer(BaseModel):
    """One method at one target."""

    target_id: str = Field(description="the target's name in the scenario")
    method: str = Field(description="the method's name in the comparison")
    solved: bool = Field(description="whether the verifier accepts the answer")
    status: str = Field(
        description="planned, or the code of the reason why not (docs/errors.md); more may come"
    )
    time_s: float = Field(description="median of the timed calls, with the warm start if any [s]")
    repeats: int = Field(description="how many calls that is of, at least one")
    detail: str | MISSING = Field(default=MISSING, description="a sentence about the answer")
    index: float | MISSING = Field(
        default=MISSING,
        description="effort or index J, recomputed from the posture, in the unit of `index_name`; "
        "absent for a failure",
    )
    cold_time_s: float | MISSING = Field(
        default=MISSING,
        description="`time_s` without the warm start [s]; absent where the method has none",
    )
    cold_repeats: int | MISSING = Field(
        default=MISSING, description="how many calls that is of, at least one"
    )
    cold_solved: bool | MISSING = Field(
        default=MISSING, description="whether the verifier accepts the cold start's answer"
    )
    cold_index: float | MISSING = Field(
        default=MISSING, description="that answer's index, in the unit of `index_name`"
    )
    cold_detail: str | MISSING = Field(default=MISSING, description="a sentence about that answer")
    iterations: int | MISSING = Field(
        default=MISSING,
        description="what the method says it spent: iterations of a programme, angles or arcs",
    )
    residuals: dict[str, float] = Field(
        description="what the verifier recomputed, by name; a name ends in its unit, if there is "
        "one"
    )
    margin: float | MISSING = Field(
        default=MISSING,
        description="smallest distance of a joint to its limit [rad, or m where that joint slides]",
    )
    joints: list[float] | MISSING = Field(
        default=MISSING, description="the posture at the target [rad, or m where a joint slides]"
    )
    gap: float | MISSING = Field(
        default=MISSING,
        description="(index - best) / abs(best), best being the least index of any method at this "
        "target; 0 or more, a share",
    )
    increase_percent: float | MISSING = Field(
        default=MISSING,
        description="100 (index - reference's) / abs(reference's) [%]; absent for the reference "
        "and for failures",
    )
    time_reduction_percent: float | MISSING = Field(
        default=MISSING,
        description="100 (1 - time / reference's), up to 100 [%]; absent for the reference and "
        "for failures",
    )
    published_index: float | MISSING = Field(
        default=MISSING, description="what the document prints, in the unit of `index_name`"
    )
    published_time_s: float | MISSING = Field(
        default=MISSING, description="what the document prints, measured on `published_on` [s]"
    )
    published_difference_percent: float | MISSING = Field(
        default=MISSING, description="100 (index - published) / abs(published) [%]"
    )
    published_increase_percent: float | MISSING = Field(
        default=MISSING, description="`increase_percent` of the document's own figures [%]"
    )
    published_time_reduction_percent: float | MISSING = Field(
        default=MISSING, description="`time_reduction_percent` of the document's own figures [%]"
    )


class MachineAnswer(BaseModel):
    """On what and with what it was measured."""

    processor: str = Field(description="its name, as the system tells it")
    cores: int = Field(description="how many processors the system counts")
    memory_gib: float = Field(description="main memory [GiB]")
    system: str = Field(description="operating system and architecture")
    python: str = Field(description="version of Python")
    versions: dict[str, str] = Field(description="of the packages that matter, by name")
    load_average: float = Field(
        description="of the last minute, at the start: processes that run or wait to"
    )
    date: str = Field(description="the day, ISO 8601 in UTC")


class ComparisonResultAnswer(BaseModel):
    """A complete comparison: what `prunus compare --json` prints."""

    scenario: str = Field(description="the scenario's name")
    title: str = Field(description="a line for people")
    origin: str = Field(description="where the targets come from, and what is reconstructed")
    index_name: str = Field(description="what is minimised, with its unit, such as effort [rad]")
    notes: list[str] = Field(description="what readers have to know, a paragraph each")
    published_on: str | MISSING = Field(
        default=MISSING, description="the machine on which a document's times were measured"
    )
    reference: str = Field(description="the method that the others are compared with")
    seeds: list[int] = Field(description="every seed that the targets depend on")
    machine: MachineAnswer = Field(description="on what and with what it was measured")
    repeats: int = Field(description="the most timed calls of a method at a target, 1 to 1000")
    findings: list[str] = Field(
        description="what the answers say about the scenario's own question, a sentence each"
    )
    rows: list[ComparisonRowAnswer] = Field(
        description="target by target, the methods of each in the scenario's order"
    )
    summaries: list[MethodSummaryAnswer] = Field(
        description="one a method, in the scenario's order"
    )
