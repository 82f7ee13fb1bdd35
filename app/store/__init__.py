"""What persists, a file a table: plans, jobs, executions, comparisons, frames, keys, tokens."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.frames import FramesFull, FrameStore, StoredFrame
from app.store.idempotency import (
    ACCEPTED,
    CREATED,
    IdempotencyStore,
    KeyedAnswer,
    KeyTaken,
    NewEntry,
    NewKey,
    StoredEntry,
    insert_key,
    new_entry,
)
from app.store.jobs import JobEnded, JobRow, JobStore, JobWork, NewPart
from app.store.plans import PlanStore, StoredPlan
from app.store.tokens import TokenRow, TokenStore

__all__ = [
    "ACCEPTED",
    "CREATED",
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "FrameStore",
    "FramesFull",
    "IdempotencyStore",
    "JobEnded",
    "JobRow",
    "JobStore",
    "JobWork",
    "KeyTaken",
    "KeyedAnswer",
    "NewEntry",
    "NewKey",
    "NewPart",
    "PlanStore",
    "RobotBusy",
    "StoredEntry",
    "StoredFrame",
    "StoredPlan",
    "TokenRow",
    "TokenStore",
    "insert_key",
    "new_entry",
    "open_engine",
]
