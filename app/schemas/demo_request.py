"""The demonstration's request: data set 3 of the thesis, five targets on a branch in space.

Origin: F. Ouyang, thesis, University of Illinois at Urbana-Champaign, 2012, section 4.3 and the
program listing of appendix B (centimetres there). The start is that program's initial posture.
"""

from typing import Any

_TARGETS = (
    ("1", (0.185, -0.057, 0.42), (-1.0, -1.0, 1.0)),
    ("2", (0.18, -0.07, 0.425), (-1.0, -1.0, 1.0)),
    ("3", (0.16, -0.083, 0.435), (-1.0, -1.0, 0.0)),
    ("4", (0.15, -0.089, 0.445), (-1.0, -1.0, 0.0)),
    ("5", (0.14, -0.095, 0.45), (-1.0, -1.0, 0.0)),
)


def demo_request() -> dict[str, Any]:
    """The body of POST /v1/plans for data set 3."""
    return {
        "robot": "tabletop",
        "tool": "laser",
        "start_joints": [0.0, 1.5707963267948966, -1.5757, 0.0, 1.5757, 0.0],
        "targets": [
            {
                "id": name,
                "position_m": list(position),
                "branch_direction": list(direction),
            }
            for name, position, direction in _TARGETS
        ],
        "options": {"method": "ncos", "order": "given", "dwell_s": 1.0},
    }
