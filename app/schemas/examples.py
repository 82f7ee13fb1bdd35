"""A body for each route that takes one, as the OpenAPI document shows it; tests send them all."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from app.schemas.demo_request import demo_request

EXAMPLES: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "PlanRequest": demo_request(),
        "ExecutionRequest": {
            "plan_id": "5f0c1d2e3a4b5c6d7e8f901234567890",
            "robot": "tabletop-sim",
        },
        "ComparisonRequest": {"scenario": "data-set-3", "methods": ["ssas", "ncos"], "repeats": 5},
        "ThinningSelectionRequest": {
            "branches": [
                {
                    "id": "b1",
                    "points_m": [[0.15, -0.1, 0.4], [0.22, 0.0, 0.41], [0.26, 0.1, 0.43]],
                    "blossoms": [
                        {"id": "1", "distance_m": 0.01},
                        {"id": "2", "distance_m": 0.06},
                        {"id": "3", "distance_m": 0.08},
                        {"id": "4", "distance_m": 0.12},
                    ],
                }
            ]
        },
        "FrameRequest": {
            "position_m": [-0.25, 0.02, 0.45],
            "quaternion_xyzw": [-0.5, 0.5, -0.5, 0.5],
        },
        "FrameRegistrationRequest": {
            "pairs": [
                {"frame_m": [0.1, -0.05, 0.6], "base_m": [0.25, -0.1, 0.4]},
                {"frame_m": [-0.1, -0.05, 0.6], "base_m": [0.25, 0.1, 0.4]},
                {"frame_m": [0.1, 0.1, 0.6], "base_m": [0.25, -0.1, 0.25]},
                {"frame_m": [-0.1, 0.1, 0.75], "base_m": [0.4, 0.1, 0.25]},
            ],
            "robot": "tabletop",
        },
        "LeaseRequest": {"holder": "operator in row 7", "duration_s": 30.0},
        "LeaseRenewal": {"duration_s": 30.0},
    }
)
"""By the name of the body's schema."""
