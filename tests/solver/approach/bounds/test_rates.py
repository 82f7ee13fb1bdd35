import numpy as np
import pytest

from solver import Robot
from solver.approach.bounds.rates import too_fast
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import posture_rate_room
from tests.solver.kinematics.arms import arms


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_a_box_is_refused_only_if_all_its_postures_are_too_fast(arm: Robot) -> None:
    geometry = wrist_geometry(arm, arm.tools[0])
    rng, refused = np.random.default_rng(4), 0
    for size in (1e-9, 1e-4, 1e-2, 0.3):
        for q in rng.uniform(arm.lower, arm.upper, (150, 6)):
            singular = rng.choice((2, 4))
            if rng.random() < 0.5:
                offset = geometry.offsets[singular] + (geometry.beta if singular == 2 else 0.0)
                q[singular] = 10.0 ** rng.uniform(-5, -1) - offset
            box = np.column_stack((q - size, q + size))
            inside = rng.uniform(box[:, 0], box[:, 1], (8, 6))
            room = max(posture_rate_room(geometry, posture) for posture in inside)
            if too_fast(geometry, box):
                refused += 1
                assert room < 0
            elif size == 1e-9:
                assert room > -1e-5
    assert refused > 50
