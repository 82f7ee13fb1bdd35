"""Poses and faults that tests of frames use."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from solver import InvalidProblem
from solver.frames.transforms import (
    RigidTransform,
    transform_from_matrix,
)
from solver.robots.model import Array

coordinates = st.floats(-2.0, 2.0)


places = st.tuples(coordinates, coordinates, coordinates)


@st.composite
def rotations(draw: st.DrawFn) -> Array:
    numbers = draw(st.tuples(*[st.floats(-1, 1)] * 4))
    assume(math.hypot(*numbers) > 0.1)
    return np.asarray(Rotation.from_quat(numbers).as_matrix())


def pose(position_m: Any, rotation: Array) -> RigidTransform:
    return transform_from_matrix(position_m, rotation.tolist())[0]


def faults(call: Any, *arguments: Any) -> dict[str, str]:
    with pytest.raises(InvalidProblem) as raised:
        call(*arguments)
    return {fault.pointer: fault.detail for fault in raised.value.faults}
