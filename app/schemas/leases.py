"""Bodies of leases, and how long one may last."""

from typing import Final

from pydantic import MISSING, BaseModel, Field

from app.schemas.strict_body import StrictBody

LEASE_HEADER: Final = "Prunus-Lease"
LEAST_LEASE_S: Final = 1.0
MOST_LEASE_S: Final = 300.0
"""A client that is gone blocks a robot no longer than this."""
USUAL_LEASE_S: Final = 30.0
LONGEST_HOLDER: Final = 100


class LeaseRequest(StrictBody):
    """Who wants to control a robot, and for how long."""

    holder: str = Field(
        min_length=1,
        max_length=LONGEST_HOLDER,
        description=f"who asks, for the others to read; 1 to {LONGEST_HOLDER} characters",
    )
    duration_s: float | MISSING = Field(
        default=MISSING,
        ge=LEAST_LEASE_S,
        le=MOST_LEASE_S,
        description=f"how long it lasts without being renewed [s], {LEAST_LEASE_S:g} to "
        f"{MOST_LEASE_S:g}; default {USUAL_LEASE_S:g}",
    )


class LeaseRenewal(StrictBody):
    """For how long from now on."""

    duration_s: float | MISSING = Field(
        default=MISSING,
        ge=LEAST_LEASE_S,
        le=MOST_LEASE_S,
        description=f"how long it lasts from now on [s], {LEAST_LEASE_S:g} to "
        f"{MOST_LEASE_S:g}; default: as long as before",
    )


class LeaseStateAnswer(BaseModel):
    """Who controls a robot, and until when."""

    robot: str = Field(description="the robot's name")
    holder: str = Field(description="who has the lease, in their own words")
    expires_at: str = Field(description="when it ends unless it is renewed, RFC 3339 in UTC")
    duration_s: float = Field(description="how long it lasts from its last renewal [s]")


class LeaseAnswer(LeaseStateAnswer):
    """A lease, for whom it was given to."""

    lease_id: str = Field(
        description="goes into the header Prunus-Lease; whoever knows it has the lease"
    )
