"""Forward kinematics, Jacobian, and the closed-form inverse for spherical wrists."""
