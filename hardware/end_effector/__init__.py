"""The end-effector: what switches it, and the process that owns its output."""
