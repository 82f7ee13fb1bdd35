"""What this worker has started, kept on disk: no execution is ever carried out twice."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import orjson

from hardware.clock import timestamp
from hardware.exceptions import JournalFailed, OrderRefused

STARTED: Final = "started"


class Journal:
    """One JSON object a line: an execution that was started, or how one ended.

    Args:
        path: the file; its folder is made.

    Raises:
        OSError: it cannot be read or written.

    Attributes:
        unfinished: executions that an earlier worker started and never ended.
    """

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._end_half_a_line()
        self._started: set[str] = set()
        self.unfinished: set[str] = set()
        for execution_id, event in _entries(path):
            self._started.add(execution_id)
            if event == STARTED:
                self.unfinished.add(execution_id)
            else:
                self.unfinished.discard(execution_id)

    def start(self, execution_id: str) -> None:
        """Note that an execution begins; durable when this returns.

        Raises:
            OrderRefused: it was begun before, here or by an earlier worker with this journal.
            JournalFailed: it cannot be noted.
        """
        if execution_id in self._started:
            raise OrderRefused(f"execution {execution_id} was begun before")
        self._write(execution_id, STARTED)
        self._started.add(execution_id)

    def end(self, execution_id: str, status: str) -> None:
        """Note how an execution ended; JournalFailed if it cannot be noted."""
        self._write(execution_id, status)
        self.unfinished.discard(execution_id)

    def _end_half_a_line(self) -> None:
        # A power cut may have left one; what is appended must not become part of it.
        with self._path.open("ab+") as file:
            file.seek(0)
            content = file.read()
            if content and not content.endswith(b"\n"):
                file.write(b"\n")

    def _write(self, execution_id: str, event: str) -> None:
        entry = {"at": timestamp(), "execution_id": execution_id, "event": event}
        try:
            with self._path.open("ab") as file:
                file.write(orjson.dumps(entry, option=orjson.OPT_APPEND_NEWLINE))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise JournalFailed(f"{self._path}: {error.strerror}") from error


def _entries(path: Path) -> Iterator[tuple[str, str]]:
    for line in path.read_bytes().splitlines():
        try:
            entry = orjson.loads(line)
            yield str(entry["execution_id"]), str(entry["event"])
        except (orjson.JSONDecodeError, KeyError, TypeError):
            continue  # half a line
