"""What kernels are made of: to be run on stand-ins for what they call, compiled or not."""

from functools import wraps
from types import ModuleType
from typing import Any

import numpy as np
import pytest


def interpreted(kernel: Any) -> Any:
    """The Python function of a kernel. It finds what it calls by name, so a test may replace it.

    As silent as the kernel where numbers are infinite or none.
    """
    function = getattr(kernel, "py_func", kernel)

    @wraps(function)
    def silent(*arguments: Any) -> Any:
        with np.errstate(all="ignore"):
            return function(*arguments)

    return silent


def interpret(monkeypatch: pytest.MonkeyPatch, module: ModuleType, **stand_ins: Any) -> None:
    """All kernels that a module knows become Python functions, but for those that are given."""
    for name, value in vars(module).copy().items():
        if hasattr(value, "py_func"):
            monkeypatch.setattr(module, name, value.py_func)
    for name, stand_in in stand_ins.items():
        monkeypatch.setattr(module, name, stand_in)
