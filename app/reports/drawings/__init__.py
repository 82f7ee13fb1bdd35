"""Pictures of plans and comparisons, a file each, with Matplotlib and without a screen."""
