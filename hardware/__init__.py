"""What moves the arm: between the solver's verified plans and the servos. See docs/architecture.md."""
