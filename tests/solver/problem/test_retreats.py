from solver import Options
from solver.problem.retreats import even_retreats


def test_rows_go_evenly_from_the_standoff_to_the_target() -> None:
    options = Options(standoff_m=0.03, path_points=4)
    assert even_retreats(options).tolist() == [0.03, 0.03 - 0.01, 0.03 - 0.02, 0.0]


def test_two_rows_are_the_ends_exactly() -> None:
    for standoff_m in (0.001, 0.04, 1.0, 1 / 3):
        assert even_retreats(Options(standoff_m=standoff_m), 2).tolist() == [standoff_m, 0.0]
