"""The nonlinear programme of the task definition, and what solves it."""
