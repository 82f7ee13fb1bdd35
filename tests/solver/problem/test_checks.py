import math

import pytest

from solver import InvalidProblem, Options, Problem, Robot, Target
from tests.solver.problems import DATA_SET_3

GOOD = DATA_SET_3[0]


def pointers(robot: Robot, **changes: object) -> list[str]:
    """Pointers of the faults of data set 3's first target with some fields changed."""
    arguments: dict[str, object] = {"targets": [GOOD], **changes}
    with pytest.raises(InvalidProblem) as raised:
        Problem(robot, **arguments)  # type: ignore[call-overload]
    return [fault.pointer for fault in raised.value.faults]


@pytest.mark.parametrize(
    ("target", "pointer"),
    [
        (Target("1", (math.nan, 0, 0), (0, 1, 0)), "#/targets/0/position_m"),
        (Target("1", (math.inf, 0, 0), (0, 1, 0)), "#/targets/0/position_m"),
        (Target("1", (0.2, 0.1), (0, 1, 0)), "#/targets/0/position_m"),
        (Target("1", (18.5, -5.7, 42.0), (0, 1, 0)), "#/targets/0/position_m"),
        (Target("1", (0.2, 0, 0.3), (0, 0, 0)), "#/targets/0/branch_direction"),
        (Target("1", (0.2, 0, 0.3), (0, 1)), "#/targets/0/branch_direction"),
        (Target("1", (0.2, 0, 0.3), (0, math.nan, 0)), "#/targets/0/branch_direction"),
        (Target("", (0.2, 0, 0.3), (0, 1, 0)), "#/targets/0/id"),
        (Target("1", (0.2, 0, 0.3), (0, 1, 0), -0.001), "#/targets/0/position_std_m"),
        (Target("1", (0.2, 0, 0.3), (0, 1, 0), math.nan), "#/targets/0/position_std_m"),
        (Target("1", (0.2, 0, 0.3), (0, 1, 0), math.inf), "#/targets/0/position_std_m"),
        (Target("1", (0.2, 0, 0.3), (0, 1, 0), 2.0), "#/targets/0/position_std_m"),
    ],
)
def test_targets_that_make_no_sense(tabletop: Robot, target: Target, pointer: str) -> None:
    assert pointers(tabletop, targets=[target]) == [pointer]


@pytest.mark.parametrize(
    ("options", "pointer"),
    [
        (Options(method="magic"), "#/options/method"),  # type: ignore[arg-type]
        (Options(order="alphabetical"), "#/options/order"),  # type: ignore[arg-type]
        (Options(norm="l3"), "#/options/norm"),  # type: ignore[arg-type]
        (Options(weights="heavy"), "#/options/weights"),  # type: ignore[arg-type]
        (Options(path_points=1), "#/options/path_points"),
        (Options(standoff_m=math.nan), "#/options/standoff_m"),
        (Options(standoff_m=0.0), "#/options/standoff_m"),
        (Options(strike_zone_m=-0.01), "#/options/strike_zone_m"),
        (Options(strike_zone_m=0.05), "#/options/strike_zone_m"),
        (Options(strike_zone_m=0.6, standoff_m=0.7), "#/options/strike_zone_m"),
        (Options(tilt_tolerance_rad=0.9), "#/options/tilt_tolerance_rad"),
        (Options(tilt_tolerance_rad=math.nan), "#/options/tilt_tolerance_rad"),
        (Options(nlp_backend="snopt"), "#/options/nlp_backend"),  # type: ignore[arg-type]
        (Options(qp_solver="gurobi"), "#/options/qp_solver"),  # type: ignore[arg-type]
        (Options(certify=True, tilt_tolerance_rad=0.1), "#/options/certify"),
        (Options(samples=0), "#/options/samples"),
        (Options(joint_weights=(1, 1)), "#/options/joint_weights"),
        (Options(joint_weights=(-1, 1, 1, 1, 1, 1)), "#/options/joint_weights"),
        (Options(joint_weights=(0, 0, 0, 0, 0, 0)), "#/options/joint_weights"),
        (Options(joint_weights=(1e308, 1, 1, 1, 1, 1)), "#/options/joint_weights"),
        (Options(include=("path", "gossip")), "#/options/include/1"),
    ],
)
def test_options_that_make_no_sense(tabletop: Robot, options: Options, pointer: str) -> None:
    assert pointers(tabletop, options=options) == [pointer]


def test_other_fields_that_make_no_sense(tabletop: Robot) -> None:
    assert pointers(tabletop, tool="chainsaw") == ["#/tool"]
    assert pointers(tabletop, start_joints=(0, 0)) == ["#/start_joints"]
    assert pointers(tabletop, start_joints=(0, 3, 0, 0, 0, 0)) == ["#/start_joints/1"]
    assert pointers(tabletop, targets=[]) == ["#/targets"]
    assert pointers(tabletop, targets=[GOOD, GOOD]) == ["#/targets/1/id"]


def test_all_faults_are_told_at_once(tabletop: Robot) -> None:
    options = Options(norm="l3")  # type: ignore[arg-type]
    found = pointers(tabletop, tool="chainsaw", options=options, targets=[])
    assert found == ["#/tool", "#/options/norm", "#/targets"]
