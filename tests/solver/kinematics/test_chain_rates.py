import numpy as np
import pytest
from numpy.typing import NDArray

from solver import Robot, load_robot
from solver.kinematics.chain_rates import fastest_on_paths, rates_behind
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import chain_of, postures_behind
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.kinematics.arms import seven_joints, ur5

Array = NDArray[np.float64]
ROBOTS = [load_robot("puma560_rail"), load_robot("tabletop"), ur5(), seven_joints()]


@pytest.mark.parametrize("name", ["tabletop", "puma560"])
def test_rates_behind_a_posture_are_the_differences_of_its_rows(name: str) -> None:
    robot = load_robot(name)
    tool, q = robot.tools[0], np.asarray(robot.home_joints) + 0.3
    retreats = np.linspace(0.04, 0.0, 401)
    rows = postures_behind(robot, tool, q, retreats)
    rates = rates_behind(robot, tool, rows)
    differences = np.abs(rows[2:] - rows[:-2]) / (retreats[:-2] - retreats[2:])[:, None]
    np.testing.assert_allclose(rates[1:-1], differences, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_at_these_rates_the_tool_goes_straight_ahead(robot: Robot) -> None:
    tool = robot.tools[0]
    for q in np.random.default_rng(8).uniform(robot.lower, robot.upper, (20, len(robot.joints))):
        rates = rates_behind(robot, tool, q[None])[0]
        columns, moving = jacobian(robot, tool, q), np.flatnonzero(rates)
        assert len(moving) <= 6
        exact = np.linalg.lstsq(columns[:, moving], _ahead(robot, q), rcond=None)[0]
        np.testing.assert_allclose(rates[moving], np.abs(exact), rtol=1e-6, atol=1e-6)


def _ahead(robot: Robot, q: Array) -> Array:
    pose = forward_kinematics(robot, robot.tools[0], q)
    return np.concatenate((pose[:3, 2], np.zeros(3)))


def test_the_fastest_place_is_found_whatever_rows_tell_of_it(tabletop: Robot) -> None:
    """Joints that swing about a wrist that is nearly straight somewhere on the way."""
    tool, standoff_m = tabletop.tools[0], 0.04
    chain, rng, compared = chain_of(tabletop, tool), np.random.default_rng(9), 0
    for q in rng.uniform(0.8 * tabletop.lower, 0.8 * tabletop.upper, (60, 6)):
        q[4] = rng.uniform(-0.1, 0.1)
        retreats = np.linspace(standoff_m, 0.0, 20001)
        rows = postures_behind(tabletop, tool, q, retreats)
        truth = rates_behind(tabletop, tool, rows).max()
        if not 100.0 < truth < 1000.0:
            continue
        for count in (2, 5, 20, 60):
            path = rows[np.round(np.linspace(0, 20000, count)).astype(int)]
            found = fastest_on_paths(chain, path[None], standoff_m, 16, 62.5)[0]
            assert found == pytest.approx(truth, rel=1e-4), f"from {count} rows"
        compared += 1
    assert compared >= 5


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-9, 1e-7])
@pytest.mark.parametrize("name", ["tabletop", "puma560"])
def test_no_joint_is_slow_beside_a_straight_wrist(name: str, apart: float) -> None:
    """The forearm turns, and joints 4 and 6 would have to make up for it in no distance."""
    robot = load_robot(name)
    for q in np.random.default_rng(5).uniform(robot.lower, robot.upper, (200, 6)):
        q[4] = apart - robot.joints[4].offset_rad
        assert rates_behind(robot, robot.tools[0], q[None]).max() > JOINT_RATE_RAD_M
