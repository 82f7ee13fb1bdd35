"""Register tables of servos as data, and what reads them."""

from hardware.servos.control_tables.loading import (
    SIMULATED_FIRMWARE,
    Register,
    ServoModel,
    servo_model,
    servo_models,
)

__all__ = ["SIMULATED_FIRMWARE", "Register", "ServoModel", "servo_model", "servo_models"]
