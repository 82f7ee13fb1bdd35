"""The scopes that a token may have."""

from typing import Final

PLAN: Final = "plan"
EXECUTE: Final = "execute"
OBSERVE: Final = "observe"
ADMIN: Final = "admin"

SCOPES: Final = {
    PLAN: "plans, jobs, thinning selections, comparisons and frames",
    EXECUTE: "whatever moves an arm, leases, and joining as a robot's worker",
    OBSERVE: "every read and the metrics",
    ADMIN: "everything",
}
"""Each scope, and what it allows."""

Scopes = tuple[str, ...]
"""Any one of these will do."""
