"""A comparison as JSON has all that the contract says, and no null."""

import dataclasses
import json
from typing import Any

import orjson
from pydantic import TypeAdapter

from app.reports.json_values import comparison_to_wire
from app.schemas.comparison_results import (
    ComparisonResultAnswer,
    ComparisonRowAnswer,
    MethodSummaryAnswer,
)
from solver.comparison.result import Comparison, MethodSummary, Row


def has_none(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(has_none, value.values()))
    return any(map(has_none, value)) if isinstance(value, list) else value is None


def test_json_has_the_fields_of_the_contract_and_no_null(comparison: Comparison) -> None:
    document = json.loads(orjson.dumps(comparison_to_wire(comparison)))
    assert not has_none(document)
    assert {"scenario", "machine", "rows"} <= set(document)
    first, *_ = document["rows"]
    assert first["target_id"] == "1"
    assert first["method"] == "ncos"
    assert first["solved"] is True
    assert first["index"] == 1.0
    assert first["time_s"] > 0
    assert (first["published_index"], first["published_time_s"]) == (1.0, 0.5)
    failed = [row for row in document["rows"] if not row["solved"]]
    assert {row["method"] for row in failed} == {"wrong", "raises", "half"}
    assert not any("index" in row or "gap" in row for row in failed)
    assert not any("published_index" in row for row in document["rows"] if row["target_id"] == "3")


def test_schema_of_the_result_is_what_is_answered(comparison: Comparison) -> None:
    for model, part in (
        (ComparisonResultAnswer, Comparison),
        (ComparisonRowAnswer, Row),
        (MethodSummaryAnswer, MethodSummary),
    ):
        assert list(model.model_fields) == [entry.name for entry in dataclasses.fields(part)]
    body = orjson.dumps(comparison_to_wire(comparison))
    answer = TypeAdapter(ComparisonResultAnswer).validate_json(body, strict=True)
    assert json.loads(answer.model_dump_json()) == json.loads(body)
