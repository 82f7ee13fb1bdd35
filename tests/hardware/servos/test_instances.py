from pathlib import Path

import pytest

from hardware.servos.instances import instance_names, load_instance
from solver.exceptions import InvalidRobot, UnknownRobot
from solver.robots.files import load_robot, robot_names


def test_every_model_is_an_instance_and_an_arm_has_a_simulated_twin() -> None:
    assert set(robot_names()) < set(instance_names())
    assert "tabletop-sim" in instance_names()
    assert list(instance_names()) == sorted(instance_names())


def test_a_robot_without_servos_has_no_twin() -> None:
    assert {"puma560", "puma560_rail"} < set(instance_names())
    assert not {"puma560-sim", "puma560_rail-sim"} & set(instance_names())
    assert not load_instance("puma560").simulated


def test_no_model_takes_the_name_of_a_twin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker for it would believe its servos to be real ones."""
    (tmp_path / "tabletop-sim.toml").write_text("")
    monkeypatch.setenv("PRUNUS_ROBOTS_DIR", str(tmp_path))
    with pytest.raises(InvalidRobot, match="simulated twin"):
        instance_names()


@pytest.mark.parametrize(("name", "simulated"), [("tabletop", False), ("tabletop-sim", True)])
def test_an_instance_is_its_model_under_its_own_name(name: str, simulated: bool) -> None:
    instance = load_instance(name)
    model = load_robot("tabletop")
    assert (instance.name, instance.model) == (name, "tabletop")
    assert instance.simulated is simulated
    assert instance.robot.version == model.version
    assert instance.robot.joints == model.joints


@pytest.mark.parametrize("name", ["", "nowhere", "nowhere-sim", "tabletop-sim-sim"])
def test_unknown_instances(name: str) -> None:
    with pytest.raises(UnknownRobot) as refused:
        load_instance(name)
    assert refused.value.known == instance_names()
