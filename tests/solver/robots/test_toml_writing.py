from dataclasses import replace

import pytest

from solver import (
    load_robot,
    parse_robot,
    robot_names,
    robot_to_toml,
)
from solver.robots.shapes import Box, Capsule, Fixture


@pytest.mark.parametrize("name", robot_names())
def test_a_model_file_is_written_as_it_was_read(name: str) -> None:
    robot = load_robot(name)
    again = parse_robot(robot_to_toml(robot))
    assert replace(again, version=robot.version) == robot


def test_bodies_with_names_of_any_script_are_written() -> None:
    robot = load_robot("tabletop")
    ball = Capsule((0.0, 0.1, 0.2), (0.0, 0.1, 0.2), 0.05)
    box = Box((0.1, 0.2, 0.3), (1.0, 2.0, 3.0), (0.5, 0.5, 0.5, -0.5))
    own = Fixture('Ständer "1" \N{PEACH}', (ball,), (box, box))
    changed = replace(
        robot, fixtures=(own,), kept_apart=((own.name, "joint_3"), ("tool", own.name))
    )
    again = parse_robot(robot_to_toml(changed))
    assert replace(again, version=robot.version) == changed
