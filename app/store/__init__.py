"""What persists: plans with the requests they answer, executions, comparisons, and frames."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.frames import FramesFull, FrameStore, StoredFrame
from app.store.plans import PlanStore, StoredPlan

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
    "open_engine",
]
