from dataclasses import replace

import pytest

from solver import (
    load_robot,
    parse_robot,
    robot_names,
    robot_to_toml,
)


@pytest.mark.parametrize("name", robot_names())
def test_a_model_file_is_written_as_it_was_read(name: str) -> None:
    robot = load_robot(name)
    again = parse_robot(robot_to_toml(robot))
    assert replace(again, version=robot.version) == robot
