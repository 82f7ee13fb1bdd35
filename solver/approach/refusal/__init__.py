"""Why a target has no approach, and the nearest change that gives it one."""
