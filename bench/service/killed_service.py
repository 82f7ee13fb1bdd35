"""The service as a process that is killed, with everything it started, and started again."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx2

HEALTHY_S = 600.0  # the first start compiles every kernel
POLL_S = 0.02
DATA = "data"
"""The folder with the service's data, in the trial's."""


class ServiceDied(Exception):
    """The service ended by itself, and what it said."""


class KilledService:
    """One service on one address and one database, in as many lives as wanted.

    Args:
        folder: of its data and its log.
        database_url: an SQLAlchemy URL; empty: SQLite in the folder.
    """

    def __init__(self, folder: Path, database_url: str) -> None:
        self._folder = folder
        self.log = folder / "service.log"
        self._environment = {**os.environ, "PRUNUS_DATABASE_URL": database_url}
        self._port = _free_port()
        self.url = f"http://127.0.0.1:{self._port}"
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Begin a life; it is not healthy yet when this returns."""
        command = [sys.executable, "-m", "app", "serve", "--port", str(self._port)]
        command += ["--data-dir", str(self._folder / DATA)]
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                command,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                # A group of its own to kill, and not a session, which Linux gives as much of the
                # processor as all the rest of the tests.
                process_group=0,
            )

    def wait_until_healthy(self) -> None:
        """Wait for the first answer.

        Raises:
            ServiceDied: none came.
        """
        self._wait_for("/healthz")

    def wait_until_ready(self) -> None:
        """Wait until the kernels are warm.

        Raises:
            ServiceDied: they never were.
        """
        self._wait_for("/readyz")

    def _wait_for(self, path: str) -> None:
        deadline = time.monotonic() + HEALTHY_S
        with httpx2.Client(base_url=self.url, timeout=5, trust_env=False) as client:
            while time.monotonic() < deadline:
                if self._process is None or self._process.poll() is not None:
                    break
                with contextlib.suppress(httpx2.TransportError):  # it does not listen yet
                    if client.get(path).status_code == 200:
                        return
                time.sleep(POLL_S)
        raise ServiceDied(self.log.read_text(errors="replace")[-2000:])

    def kill(self) -> None:
        """SIGKILL to the service and its solver processes at once.

        Raises:
            ServiceDied: it had ended by itself.
        """
        process, self._process = self._process, None
        if process is None:
            return
        ended_alone = process.poll() is not None
        # The group is the service's own; its leader is not reaped before this.
        if not ended_alone:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        if ended_alone:
            raise ServiceDied(self.log.read_text(errors="replace")[-2000:])


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port: int = listener.getsockname()[1]
        return port
