"""What persists: plans with their requests, executions, comparisons, frames, keys and tokens."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.frames import FramesFull, FrameStore, StoredFrame
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
from app.store.tokens import TokenRow, TokenStore

__all__ = [
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "FrameStore",
    "FramesFull",
    "IdempotencyStore",
    "KeyTaken",
    "KeyedAnswer",
    "NewEntry",
    "NewKey",
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
