"""An execution as it stands, and how it changes: values in, values out, no clock and no store."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import orjson

from app.schemas.present import present
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    ENDED,
    EXECUTING,
    FAILED,
    NOT_STARTED,
    PAUSED,
    SKIPPED,
    UNKNOWN,
    ExecutionAccount,
    Failure,
    TargetAccount,
)

WORKER_LOST: Final = "worker_lost"
LINK_LOST: Final = "link_lost"
SERVICE_RESTARTED: Final = "service_restarted"
PLAN_OUTDATED: Final = "plan_outdated"
SOLVER_FAILED: Final = "solver_failed"
STOPPED: Final = "stopped"
STORE_LOST: Final = "store_lost"

EXECUTION_ERROR_CODES: Final = (
    WORKER_LOST,
    LINK_LOST,
    SERVICE_RESTARTED,
    PLAN_OUTDATED,
    SOLVER_FAILED,
    STOPPED,
    STORE_LOST,
)
"""Codes of the errors with which the service itself ends an execution."""

OUT_OF_SIGHT: Final = (WORKER_LOST, LINK_LOST, SERVICE_RESTARTED)
"""Of these, where the arm may have gone on: what the worker says later is still taken."""

STATUSES: Final = (EXECUTING, PAUSED, COMPLETED, FAILED, CANCELED)
"""What a worker may say that an execution's status is."""


@dataclass(frozen=True)
class Execution:
    """An execution; the fields are those of the answer's body.

    Attributes:
        targets: all of the plan, in its order; those without an approach are skipped.
    """

    id: str
    plan_id: str
    robot: str
    simulated: bool
    status: str
    created_at: str
    targets: tuple[TargetAccount, ...]
    started_at: str | None = None
    ended_at: str | None = None
    segment: str | None = None
    error: Failure | None = None

    @property
    def location(self) -> str:
        """Its path."""
        return f"/v1/executions/{self.id}"

    @property
    def ended(self) -> bool:
        """Whether nothing of it is to come any more."""
        return self.status in ENDED

    @property
    def may_be_corrected(self) -> bool:
        """Whether it ended while the worker could not be heard."""
        return self.ended and self.error is not None and self.error.code in OUT_OF_SIGHT


def targets_of_plan(approaches: Sequence[Mapping[str, Any]], at: str) -> tuple[TargetAccount, ...]:
    """The account of a plan's targets before anything has moved."""
    return tuple(_target_of_plan(approach, at) for approach in approaches)


def _target_of_plan(approach: Mapping[str, Any], at: str) -> TargetAccount:
    if "reason" not in approach:
        return TargetAccount(approach["target_id"], NOT_STARTED)
    reason = approach["reason"]
    error = Failure(reason["code"], reason["detail"], at)
    return TargetAccount(approach["target_id"], SKIPPED, error=error)


def with_account(execution: Execution, account: ExecutionAccount, at: str) -> Execution:
    """An active execution after the worker has given its account."""
    running = account.status in (EXECUTING, PAUSED, COMPLETED)
    told = replace(
        execution,
        status=account.status,
        targets=_told(execution.targets, account.targets),
        started_at=at if running and execution.started_at is None else execution.started_at,
        segment=account.segment,
        error=account.error,
    )
    return _at_rest(told, at) if told.ended else told


def corrected(execution: Execution, account: ExecutionAccount) -> Execution:
    """An execution that ended out of sight, with what the worker says of its targets."""
    targets = _told(execution.targets, account.targets)
    return replace(execution, targets=_not_executing(targets))


def ended(execution: Execution, status: str, error: Failure | None, at: str) -> Execution:
    """An active execution ended by the service."""
    return _at_rest(replace(execution, status=status, error=error), at)


def _at_rest(execution: Execution, at: str) -> Execution:
    targets = _not_executing(execution.targets)
    return replace(execution, targets=targets, segment=None, ended_at=at)


def _not_executing(targets: Sequence[TargetAccount]) -> tuple[TargetAccount, ...]:
    return tuple(
        replace(target, status=UNKNOWN) if target.status == EXECUTING else target
        for target in targets
    )


def _told(
    known: Sequence[TargetAccount], account: Sequence[TargetAccount]
) -> tuple[TargetAccount, ...]:
    by_id = {target.target_id: target for target in account}
    return tuple(by_id.get(target.target_id, target) for target in known)


def execution_to_json(execution: Execution) -> str:
    """The answer's body."""
    values = {name: getattr(execution, name) for name in Execution.__dataclass_fields__}
    targets = [present(**asdict(target)) for target in execution.targets]
    return orjson.dumps(present(**{**values, "targets": targets})).decode()


def execution_from_json(document: str) -> Execution:
    """The execution of an answer's body."""
    values = orjson.loads(document)
    targets = tuple(_target_from_json(target) for target in values["targets"])
    return Execution(**{**values, "targets": targets, "error": _failure(values)})


def _target_from_json(values: Mapping[str, Any]) -> TargetAccount:
    measured = {
        name: tuple(value) for name, value in values.items() if name.startswith("measured_")
    }
    return TargetAccount(**{**values, **measured, "error": _failure(values)})


def _failure(values: Mapping[str, Any]) -> Failure | None:
    return Failure(**values["error"]) if "error" in values else None
