"""Pictures of plans, with Matplotlib and without a screen."""
