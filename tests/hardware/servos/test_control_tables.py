from itertools import pairwise

import pytest

from hardware.servos.control_tables import ServoModel, servo_model, servo_models

# ROBOTIS e-manual, RX-28, RX-64 and EX-106+: address, bytes.
SHARED = {
    "model_number": (0, 2),
    "firmware_version": (2, 1),
    "id": (3, 1),
    "baud_rate": (4, 1),
    "return_delay_time": (5, 1),
    "cw_angle_limit": (6, 2),
    "ccw_angle_limit": (8, 2),
    "temperature_limit": (11, 1),
    "lowest_voltage": (12, 1),
    "highest_voltage": (13, 1),
    "max_torque": (14, 2),
    "status_return_level": (16, 1),
    "alarm_led": (17, 1),
    "shutdown": (18, 1),
    "torque_enable": (24, 1),
    "led": (25, 1),
    "cw_compliance_margin": (26, 1),
    "ccw_compliance_margin": (27, 1),
    "cw_compliance_slope": (28, 1),
    "ccw_compliance_slope": (29, 1),
    "goal_position": (30, 2),
    "moving_speed": (32, 2),
    "torque_limit": (34, 2),
    "present_position": (36, 2),
    "present_speed": (38, 2),
    "present_load": (40, 2),
    "present_voltage": (42, 1),
    "present_temperature": (43, 1),
    "registered_instruction": (44, 1),
    "moving": (46, 1),
    "lock": (47, 1),
    "punch": (48, 2),
}
EX_ONLY = {"drive_mode": (10, 1), "sensed_current": (56, 2)}
READ_ONLY = {
    "model_number",
    "firmware_version",
    "present_position",
    "present_speed",
    "present_load",
    "present_voltage",
    "present_temperature",
    "registered_instruction",
    "moving",
    "sensed_current",
}

every_model = pytest.mark.parametrize("model", servo_models().values(), ids=lambda each: each.name)


def test_the_servos_of_the_arm_are_there() -> None:
    numbers = {name: model.model_number for name, model in servo_models().items()}
    assert numbers == {"RX-28": 28, "RX-64": 64, "EX-106+": 107}


@every_model
def test_addresses_and_sizes(model: ServoModel) -> None:
    places = {name: (each.address, each.size) for name, each in model.registers.items()}
    assert places == (SHARED | EX_ONLY if model.name == "EX-106+" else SHARED)


@every_model
def test_registers_do_not_overlap(model: ServoModel) -> None:
    ordered = sorted(model.registers.values(), key=lambda register: register.address)
    for register, following in pairwise(ordered):
        assert register.address + register.size <= following.address


@every_model
def test_access(model: ServoModel) -> None:
    assert {name for name, each in model.registers.items() if not each.writable} == (
        READ_ONLY & model.registers.keys()
    )


@every_model
def test_defaults_fit_their_registers(model: ServoModel) -> None:
    assert model.defaults
    for name, value in model.defaults.items():
        register = model.registers[name]
        assert int.from_bytes(register.encode(value), "little") == value


@every_model
def test_a_new_servo_shuts_down_on_overload_and_overheating_and_moves_everywhere(
    model: ServoModel,
) -> None:
    assert model.defaults["shutdown"] == 0b100100
    assert model.defaults["ccw_angle_limit"] == model.highest_position
    assert model.registers["goal_position"].highest == model.highest_position


@every_model
def test_what_survives_power_off(model: ServoModel) -> None:
    assert model.registers["shutdown"].survives_power_off
    assert not model.registers["torque_enable"].survives_power_off


def test_values_that_a_register_cannot_hold() -> None:
    register = servo_model("RX-64").registers["goal_position"]
    assert register.encode(500) == b"\xf4\x01"
    for value in (-1, 1024):
        with pytest.raises(ValueError, match="goal_position holds 0 to 1023"):
            register.encode(value)


def test_unknown_servo() -> None:
    with pytest.raises(KeyError):
        servo_model("AX-12")
