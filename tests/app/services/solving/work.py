"""What tests have solver processes do. It imports little, as each process imports it anew."""

import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn


def nothing() -> None:
    pass


def fail_to_start() -> NoReturn:
    raise RuntimeError("no kernels")


def die_once(mark: str) -> None:
    """Preparation that fails the first time."""
    if not Path(mark).exists():
        Path(mark).touch()
        os._exit(1)


def count_bytes(count: int) -> bytes:
    return bytes(count)


def pid() -> int:
    return os.getpid()


def fail(value: str) -> NoReturn:
    raise ValueError(value)


def begin_and_sleep(begun: str) -> None:
    Path(begun).touch()
    time.sleep(60.0)


def pid_when_all_are_there(folder: str, count: int) -> int:
    """The process's number, after so many processes are at work at the same time."""
    (Path(folder) / str(os.getpid())).touch()
    _wait(lambda: len(list(Path(folder).iterdir())) >= count)
    return os.getpid()


def pid_when_told(begun: str, told: str) -> int:
    """The process's number, once a file is there; another one tells that it has begun."""
    Path(begun).touch()
    _wait(Path(told).exists)
    return os.getpid()


def unsendable() -> Any:
    return threading.Lock()


class Particular(Exception):
    def __init__(self, *, value: str) -> None:
        super().__init__(f"particular {value}")


def fail_particularly() -> NoReturn:
    raise Particular(value="case")


def _wait(condition: Callable[[], bool]) -> None:
    while not condition():
        time.sleep(0.01)
