"""Robots and their models over HTTP."""

import math

import pytest

from tests.app.conftest import Server
from tests.app.fake_worker import worker


def test_robots(server: Server) -> None:
    listed = server.client.get("/v1/robots").json()["robots"]
    assert "tabletop" in {robot["name"] for robot in listed}
    robot = server.client.get("/v1/robots/tabletop").json()
    assert len(robot["joints"]) == len(robot["home_joints"]) == 6
    assert all(joint["velocity_rad_s"] > 0 for joint in robot["joints"])
    assert {tool["name"] for tool in robot["tools"]} == {"laser", "scaffold"}
    assert all(tool["reach_m"] > 0 for tool in robot["tools"])
    assert robot["model_version"]


def test_a_rail_is_told_in_metres(server: Server) -> None:
    robot = server.client.get("/v1/robots/puma560_rail").json()
    rail, waist = robot["joints"][:2]
    assert (rail["kind"], waist["kind"]) == ("prismatic", "revolute")
    assert (rail["lower_m"], rail["upper_m"], rail["velocity_m_s"]) == (-0.6, 0.6, 0.5)
    assert not [name for name in rail if name.endswith(("_rad_s", "_rad_s2")) or "er_rad" in name]
    assert not [name for name in waist if name.startswith(("lower_m", "upper_m", "velocity_m"))]
    assert waist["upper_rad"] == pytest.approx(math.radians(160))
    assert robot["mount_rpy_rad"] == pytest.approx([-math.pi / 2, 0, 0])
    assert len(robot["home_joints"]) == 7
    assert "estimated" in robot["mass_source"]
    listed = {entry["name"] for entry in server.client.get("/v1/robots").json()["robots"]}
    assert {"puma560", "puma560_rail", "tabletop", "tabletop-sim"} <= listed
    assert not {"puma560-sim", "puma560_rail-sim"} & listed


def test_robots_are_instances(server: Server) -> None:
    listed = {entry["name"]: entry for entry in server.client.get("/v1/robots").json()["robots"]}
    assert listed["tabletop"]["simulated"] is False
    twin = listed["tabletop-sim"]
    assert (twin["simulated"], twin["model"]) == (True, "tabletop")
    assert twin["model_version"] == listed["tabletop"]["model_version"]
    detail = server.client.get("/v1/robots/tabletop-sim").json()
    assert (detail["simulated"], detail["model"], detail["name"]) == (
        True, "tabletop", "tabletop-sim",
    )  # fmt: skip
    assert "calibration_rad" not in detail
    with worker(server):
        detail = server.client.get("/v1/robots/tabletop-sim").json()
        assert detail["calibration_rad"] == [0.0, 0.01, 0.0, 0.0, 0.0, 0.0]
