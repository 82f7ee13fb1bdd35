"""Registers of servos: a TOML file a model of servo, and what reads them."""

from hardware.servos.control_tables.loading import (
    SIMULATED_FIRMWARE,
    Register,
    ServoModel,
    servo_model,
    servo_models,
)

__all__ = ["SIMULATED_FIRMWARE", "Register", "ServoModel", "servo_model", "servo_models"]
