"""What persists: plans with the requests they answer, their executions, and comparisons."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.plans import PlanStore, StoredPlan

__all__ = [
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "PlanStore",
    "RobotBusy",
    "StoredPlan",
    "open_engine",
]
