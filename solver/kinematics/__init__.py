"""Forward and inverse kinematics, in closed form and numerical; gravity and inertia."""
