from solver import Problem, Robot, Target
from tests.solver.problems import DATA_SET_3

GOOD = DATA_SET_3[0]


def test_defaults_are_resolved(tabletop: Robot) -> None:
    problem = Problem(tabletop, [GOOD])
    assert problem.mounted_tool.name == "laser"
    assert problem.start == tabletop.home_joints
    assert problem.joint_weights == (1.0,) * 6
    assert problem.options.include == ("path", "transfer", "trajectory")
    many = [Target(str(k), GOOD.position_m, GOOD.branch_direction) for k in range(51)]
    assert Problem(tabletop, many).options.include == ("path",)
