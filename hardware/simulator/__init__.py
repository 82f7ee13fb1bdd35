"""Simulated servos that speak Protocol 1.0 byte for byte, with faults, a row each."""

from hardware.simulator.bus import SimulatedBus, simulated_arm
from hardware.simulator.servo import Clock, SimulatedServo

__all__ = ["Clock", "SimulatedBus", "SimulatedServo", "simulated_arm"]
