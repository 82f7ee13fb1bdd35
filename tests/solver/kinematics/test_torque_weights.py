from dataclasses import replace

import numpy as np
import pytest

from solver import InvalidProblem, Options, Problem, Robot, load_robot, robot_names, solve
from solver.kinematics.torque_weights import torque_weights
from tests.solver.problems import DATA_SET_3, data_set_3


@pytest.mark.parametrize("name", robot_names())
def test_weights_have_mean_one_and_the_waist_costs_more_than_the_wrist(name: str) -> None:
    """T 5.2.2: joint 1 needs more than joint 6."""
    robot = load_robot(name)
    for tool in robot.tools:
        weights = torque_weights(robot, tool)
        assert np.mean(weights) == pytest.approx(1.0)
        waist, wrist = weights[-6], weights[-1]
        assert waist > 5 * wrist > 0
        assert weights[-5] == max(weights[-6:])  # the shoulder carries the arm


def test_a_heavier_tool_shifts_weight_towards_the_wrist(tabletop: Robot) -> None:
    light, heavy = (replace(tabletop.tools[0], mass_kg=mass) for mass in (0.0, 0.3))
    before, after = torque_weights(tabletop, light), torque_weights(tabletop, heavy)
    assert after[4] / after[1] > before[4] / before[1]


def test_weights_scale_with_no_unit_of_mass(tabletop: Robot) -> None:
    """All masses and inertias times three: the same weights."""
    joints = []
    for joint in tabletop.joints:
        assert joint.link is not None
        xx, yy, zz, xy, xz, yz = (3 * value for value in joint.link.inertia_kg_m2)
        link = replace(
            joint.link,
            mass_kg=3 * joint.link.mass_kg,
            inertia_kg_m2=(xx, yy, zz, xy, xz, yz),
            drive_inertia=3 * joint.link.drive_inertia,
        )
        joints.append(replace(joint, link=link))
    tripled = replace(tabletop, joints=tuple(joints))
    tool = tabletop.tools[0]
    heavier = torque_weights(tripled, replace(tool, mass_kg=3 * tool.mass_kg))
    assert heavier == pytest.approx(torque_weights(tabletop, tool))


def test_the_problem_takes_them_and_a_list_replaces_them(tabletop: Robot) -> None:
    torque = data_set_3(tabletop, weights="torque", method="floating_z")
    assert torque.joint_weights == torque_weights(tabletop, torque.mounted_tool)
    listed = data_set_3(tabletop, weights="torque", joint_weights=(1, 2, 3, 4, 5, 6))
    assert listed.joint_weights == (1, 2, 3, 4, 5, 6)
    plan = solve(torque)
    uniform = solve(data_set_3(tabletop, method="floating_z"))
    assert plan.planned == uniform.planned == 5
    assert plan.total_effort != pytest.approx(uniform.total_effort)


def test_a_robot_without_masses_refuses_them(tabletop: Robot) -> None:
    joints = (replace(tabletop.joints[0], link=None), *tabletop.joints[1:])
    robot = replace(tabletop, joints=joints)
    with pytest.raises(InvalidProblem) as refused:
        Problem(robot, DATA_SET_3, options=Options(weights="torque"))
    (fault,) = refused.value.faults
    assert fault.pointer == "#/options/weights"
    assert "no masses" in fault.detail
    listed = Options(weights="torque", joint_weights=(1,) * 6)
    assert Problem(robot, DATA_SET_3, options=listed).joint_weights == (1,) * 6
