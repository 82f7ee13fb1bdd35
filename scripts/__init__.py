"""What the Makefile runs, and what writes documents from the code."""
