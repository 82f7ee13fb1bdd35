"""What moves the arm: between verified plans and servos. See docs/architecture.md."""
