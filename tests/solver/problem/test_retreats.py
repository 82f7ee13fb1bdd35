import numpy as np
import pytest

from solver import Options
from solver.problem.retreats import (
    LOOKED_AT_ROWS,
    LOOKED_AT_SPACING_M,
    even_retreats,
    looked_at_retreats,
)


def test_rows_go_evenly_from_the_standoff_to_the_target() -> None:
    options = Options(standoff_m=0.03, path_points=4)
    assert even_retreats(options).tolist() == [0.03, 0.03 - 0.01, 0.03 - 0.02, 0.0]


def test_two_rows_are_the_ends_exactly() -> None:
    for standoff_m in (0.001, 0.04, 1.0, 1 / 3):
        assert even_retreats(Options(standoff_m=standoff_m), 2).tolist() == [standoff_m, 0.0]


@pytest.mark.parametrize("standoff_m", [0.001, 0.01, 0.04, 0.0405, 0.2, 1.0])
def test_what_is_looked_at_depends_on_the_standoff_alone(standoff_m: float) -> None:
    found = [
        looked_at_retreats(Options(standoff_m=standoff_m, path_points=rows)).tolist()
        for rows in (2, 20, 200)
    ]
    assert found[0] == found[1] == found[2]
    assert found[0][0] == standoff_m
    assert found[0][-1] == 0.0
    assert len(found[0]) >= LOOKED_AT_ROWS
    assert -np.diff(found[0]).min() <= LOOKED_AT_SPACING_M + 1e-15
