"""What persists: plans with the requests they answer, their executions, comparisons, and tokens."""

from app.store.comparisons import ComparisonStore
from app.store.database import open_engine
from app.store.executions import ExecutionRow, ExecutionStore, RobotBusy
from app.store.plans import PlanStore, StoredPlan
from app.store.tokens import TokenRow, TokenStore

__all__ = [
    "ComparisonStore",
    "ExecutionRow",
    "ExecutionStore",
    "PlanStore",
    "RobotBusy",
    "StoredPlan",
    "TokenRow",
    "TokenStore",
    "open_engine",
]
