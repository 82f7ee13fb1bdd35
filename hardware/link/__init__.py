"""The robot link: its messages, which both ends share, and the worker's end."""
