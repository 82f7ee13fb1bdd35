"""The side of the servos: bus, mapping, worker, and a simulated bus that speaks their bytes.

Ticks (servo units) exist in this package only; joint vectors are radians in the model's order.
"""
