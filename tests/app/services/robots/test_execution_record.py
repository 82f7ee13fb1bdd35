import json
from dataclasses import replace
from typing import Any

import pytest

from app.services.robots.execution_record import (
    OUT_OF_SIGHT,
    Execution,
    corrected,
    ended,
    execution_from_json,
    execution_to_json,
    targets_of_plan,
    with_account,
)
from hardware.link.messages import ExecutionAccount, Failure, TargetAccount

FAILURE = Failure("worker_lost", "it left", "t1")
MEASURED = TargetAccount(
    "1", "done", (0.1,) * 6, (0.2,) * 6, standby_error_m=0.001, target_error_m=0.002
)
APPROACHES: list[dict[str, Any]] = [
    {"target_id": "1", "status": "planned"},
    {"target_id": "far", "status": "infeasible", "reason": {"code": "out_of_reach", "detail": "x"}},
    {"target_id": "2", "status": "planned"},
]
QUEUED = Execution(
    "e", "p", "tabletop-sim", True, "queued", "t0", targets_of_plan(APPROACHES, "t0")
)


def account(status: str, *targets: TargetAccount, **others: object) -> ExecutionAccount:
    return ExecutionAccount("e", status, targets, **others)  # type: ignore[arg-type]


def statuses(execution: Execution) -> list[str]:
    return [target.status for target in execution.targets]


def test_targets_without_an_approach_are_skipped_from_the_start() -> None:
    assert statuses(QUEUED) == ["not_started", "skipped", "not_started"]
    assert QUEUED.targets[1].error == Failure("out_of_reach", "x", "t0")


def test_an_account_is_taken_over_target_by_target() -> None:
    told = account("executing", TargetAccount("2", "executing"), segment="transfer")
    once = with_account(QUEUED, told, "t1")
    assert statuses(once) == ["not_started", "skipped", "executing"]
    assert (once.status, once.started_at, once.segment) == ("executing", "t1", "transfer")
    stranger = account("completed", MEASURED, TargetAccount("99", "done"))
    twice = with_account(once, stranger, "t2")
    assert [target.target_id for target in twice.targets] == ["1", "far", "2"]
    assert twice.targets[0] == MEASURED
    assert (twice.started_at, twice.ended_at, twice.segment) == ("t1", "t2", None)


def test_a_refused_order_never_started() -> None:
    refused = with_account(QUEUED, account("failed", error=FAILURE), "t1")
    assert (refused.status, refused.started_at, refused.ended_at) == ("failed", None, "t1")
    assert refused.error == FAILURE


@pytest.mark.parametrize("by_service", [True, False])
def test_nothing_is_executing_when_it_has_ended(by_service: bool) -> None:
    running = with_account(QUEUED, account("executing", TargetAccount("1", "executing")), "t1")
    over = (
        ended(running, "failed", FAILURE, "t2")
        if by_service
        else with_account(running, account("failed", TargetAccount("1", "executing")), "t2")
    )
    assert statuses(over) == ["unknown", "skipped", "not_started"]
    assert (over.ended, over.ended_at) == (True, "t2")


def test_a_late_account_corrects_the_targets_alone() -> None:
    lost = ended(QUEUED, "failed", FAILURE, "t1")
    late = corrected(lost, account("completed", MEASURED, TargetAccount("2", "executing")))
    assert statuses(late) == ["done", "skipped", "unknown"]
    assert replace(late, targets=lost.targets) == lost


def test_only_what_ended_out_of_sight_may_be_corrected() -> None:
    for code in OUT_OF_SIGHT:
        failure = replace(FAILURE, code=code)
        assert ended(QUEUED, "failed", failure, "t1").may_be_corrected
    assert not QUEUED.may_be_corrected
    assert not ended(QUEUED, "canceled", None, "t1").may_be_corrected
    stopped = replace(FAILURE, code="stopped")
    assert not ended(QUEUED, "failed", stopped, "t1").may_be_corrected


def test_json_has_no_null_and_comes_back_as_it_was() -> None:
    told = account("failed", MEASURED, replace(MEASURED, target_id="2", error=FAILURE))
    for execution in (QUEUED, with_account(QUEUED, told, "t1")):
        document = execution_to_json(execution)
        assert "null" not in document
        assert json.loads(document)["targets"][1]["error"]["code"] == "out_of_reach"
        assert execution_from_json(document) == execution
