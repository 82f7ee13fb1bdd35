"""Reads the register tables: one TOML file a servo, and one with the registers that all share."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

SHARED_TABLE: Final = "registers.toml"
FIRST_VOLATILE_ADDRESS: Final = 24
# What a simulated servo reports as its firmware version; no real one is known to.
SIMULATED_FIRMWARE: Final = 255


@dataclass(frozen=True)
class Register:
    """A value in a servo's control table: `size` bytes, low byte first, from `address` on."""

    name: str
    address: int
    size: int
    access: str
    highest: int

    @property
    def writable(self) -> bool:
        """Whether an instruction may write it."""
        return self.access == "write"

    @property
    def survives_power_off(self) -> bool:
        """Whether it is in the part of the table that is kept without power."""
        return self.address < FIRST_VOLATILE_ADDRESS

    def encode(self, value: int) -> bytes:
        """The value's bytes; ValueError if the register cannot hold it."""
        if not 0 <= value <= self.highest:
            raise ValueError(f"{self.name} holds 0 to {self.highest}, not {value}")
        return value.to_bytes(self.size, "little")


@dataclass(frozen=True)
class ServoModel:
    """A kind of servo: what its ticks mean and where its registers are.

    Attributes:
        highest_position: position counts go from 0 to this [ticks].
        range_deg: the angle that they span [deg].
        no_load_rpm: full speed at 18.5 V [rpm].
        registers: by name.
        defaults: what a new servo's registers hold; absent: 0.
    """

    name: str
    model_number: int
    highest_position: int
    range_deg: float
    no_load_rpm: float
    stall_torque_nm: float
    registers: Mapping[str, Register]
    defaults: Mapping[str, int]


@cache
def servo_models() -> Mapping[str, ServoModel]:
    """Every servo that ships, by its name."""
    folder = resources.files("hardware.servos.control_tables")
    shared = _table(SHARED_TABLE)
    names = sorted(Path(entry.name).name for entry in folder.iterdir())
    models = [
        _model(_table(name), shared)
        for name in names
        if name.endswith(".toml") and name != SHARED_TABLE
    ]
    return MappingProxyType({model.name: model for model in models})


def servo_model(name: str) -> ServoModel:
    """The servo of that name; KeyError if no table has it."""
    return servo_models()[name]


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads((resources.files("hardware.servos.control_tables") / name).read_text())


def _model(table: dict[str, Any], shared: Mapping[str, Any]) -> ServoModel:
    rows = {**shared, **table.pop("registers", {})}
    highest_position = table["highest_position"]
    registers = {
        name: Register(
            name=name,
            address=row["address"],
            size=row["size"],
            access=row["access"],
            highest=row.get("highest", highest_position),
        )
        for name, row in rows.items()
    }
    defaults = MappingProxyType(table.pop("defaults"))
    return ServoModel(registers=MappingProxyType(registers), defaults=defaults, **table)
