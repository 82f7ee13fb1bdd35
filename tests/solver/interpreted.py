"""What a kernel is made of: to be run on stand-ins for what it calls, compiled or not."""

from typing import Any


def interpreted(kernel: Any) -> Any:
    """The Python function of a kernel. It finds what it calls by name, so a test may replace it."""
    return getattr(kernel, "py_func", kernel)
