"""What persists: plans with their requests, executions, comparisons, and idempotency keys."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.idempotency import (
    IdempotencyStore,
    KeyedAnswer,
    KeyTaken,
    NewEntry,
    NewKey,
    StoredEntry,
    insert_key,
    new_entry,
)
from app.store.plans import PlanStore, StoredPlan

__all__ = [
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "IdempotencyStore",
    "KeyTaken",
    "KeyedAnswer",
    "NewEntry",
    "NewKey",
    "PlanStore",
    "RobotBusy",
    "StoredEntry",
    "StoredPlan",
    "insert_key",
    "new_entry",
    "open_engine",
]
