from dataclasses import asdict, replace

import pytest

from solver import InvalidProblem, Options, Problem, Robot, Target
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


def test_the_third_in_place_are_the_options(tabletop: Robot) -> None:
    options = Options(method="ssas")
    problem = Problem(tabletop, [GOOD], options)
    assert problem == Problem(tabletop, [GOOD], options=options)
    assert problem.options.method == "ssas"
    assert replace(problem, tool="scaffold").mounted_tool.name == "scaffold"


def test_the_old_order_is_understood_and_told(tabletop: Robot) -> None:
    options, start = Options(method="ssas"), (0.1,) * 6
    new = Problem(tabletop, [GOOD], options, tool="scaffold", start_joints=start)
    with pytest.warns(DeprecationWarning, match="by name"):
        assert Problem(tabletop, [GOOD], "scaffold", start, options) == new
    with pytest.warns(DeprecationWarning, match="by name"):
        assert Problem(tabletop, [GOOD], "scaffold", start, options=options) == new
    with pytest.warns(DeprecationWarning, match="by name"):
        assert Problem(tabletop, [GOOD], None, None, options).options.method == "ssas"


def test_what_it_does_not_know_is_refused(tabletop: Robot) -> None:
    with pytest.raises(TypeError, match="option"):
        Problem(tabletop, [GOOD], option=Options())  # type: ignore[call-overload]
    with pytest.raises(TypeError, match="options"):
        Problem(tabletop, [GOOD], Options(), options=Options())  # type: ignore[call-overload]


def test_a_dict_in_place_of_a_target_is_told(tabletop: Robot) -> None:
    with pytest.raises(InvalidProblem) as caught:
        Problem(tabletop, [GOOD, asdict(GOOD)])  # type: ignore[list-item]
    (fault,) = caught.value.faults
    assert fault.path == ("targets", 1)
    assert "not a dict" in fault.detail
    assert "Target(**it)" in fault.detail
    assert Target(**asdict(GOOD)) == GOOD
