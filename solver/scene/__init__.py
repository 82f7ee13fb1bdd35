"""What stands in the arm's way, the arm's own body, and how near they come to each other."""
