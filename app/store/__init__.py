"""What persists: plans with the requests they answer."""

from app.store.plans import PlanStore

__all__ = ["PlanStore"]
