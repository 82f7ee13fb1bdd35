"""The side of the servos: the worker, what it drives, and a simulation that speaks its bytes.

Ticks (servo units) exist in this package only; joint vectors are radians in the model's order.
"""
