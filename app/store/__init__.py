"""What persists: plans with the requests they answer, executions, comparisons, frames, tokens."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.frames import FramesFull, FrameStore, StoredFrame
from app.store.plans import PlanStore, StoredPlan
from app.store.tokens import TokenRow, TokenStore

__all__ = [
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "FrameStore",
    "FramesFull",
    "PlanStore",
    "RobotBusy",
    "StoredFrame",
    "StoredPlan",
    "TokenRow",
    "TokenStore",
    "open_engine",
]
