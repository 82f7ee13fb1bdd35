import pytest

from solver import Options, Problem, load_robot, robot_names, solve
from solver.warm_up import home_target
from tests.solver.kinematics.arms import ur5


@pytest.mark.parametrize("name", robot_names())
def test_the_warm_up_target_is_planned_on_every_robot(name: str) -> None:
    """One that is refused early would leave kernels uncompiled."""
    robot = load_robot(name)
    options = Options(method="floating_z", samples=360)
    assert solve(Problem(robot, [home_target(robot)], options=options)).planned == 1


def test_it_fits_an_arm_without_a_closed_form() -> None:
    assert solve(Problem(ur5(), [home_target(ur5())])).planned == 1
