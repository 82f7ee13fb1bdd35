"""What persists: plans with the requests they answer, and their executions."""

from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.plans import PlanStore, StoredPlan

__all__ = [
    "ExecutionRow",
    "ExecutionStore",
    "PlanStore",
    "RobotBusy",
    "StoredPlan",
    "open_engine",
]
