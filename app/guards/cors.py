"""What pages of the origins that the operator allows may send and read."""

from typing import Any, Final

from app.schemas.leases import LEASE_HEADER

PREFLIGHT_MAX_AGE_S: Final = 600

# No credentials: tokens are sent by the page itself, and there are no cookies.
CORS_RULES: Final[dict[str, Any]] = {
    "allow_methods": ["GET", "POST", "PUT", "DELETE"],
    "allow_headers": [
        "Authorization",
        "Content-Type",
        "Idempotency-Key",
        "Last-Event-ID",
        "Prefer",
        LEASE_HEADER,
        "X-Request-Id",
    ],
    "expose_headers": [
        "Idempotency-Replayed",
        "Location",
        "Preference-Applied",
        "Retry-After",
        "WWW-Authenticate",
        "X-Request-Id",
    ],
    "max_age": PREFLIGHT_MAX_AGE_S,
}
