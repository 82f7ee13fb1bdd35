"""What stands in the arm's way: obstacles, a file and a row each. None yet; scenes are refused."""
