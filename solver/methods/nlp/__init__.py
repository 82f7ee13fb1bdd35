"""The nonlinear programme of the task definition, its starts, and the backends that solve it."""
