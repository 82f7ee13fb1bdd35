"""A PostgreSQL server of one's own, from the distribution's packages.

It refuses to run as root, so its programs then run as the user that its package made.
"""

import os
import pwd
import shutil
import socket
import subprocess
import tempfile
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

import psycopg

INSTALL = "On Debian, as root: apt-get install postgresql, or make setup APT=1"
ADMINISTRATOR = "prunus"
START_S = 60


def find_programs() -> Path | None:
    """The folder with initdb and pg_ctl, the newest version's; None if there is none."""
    installed = Path("/usr/lib/postgresql").glob("*/bin/initdb")
    newest = sorted(installed, key=lambda path: float(path.parts[-3]))
    if newest:
        return newest[-1].parent
    found = shutil.which("initdb")
    return None if found is None else Path(found).resolve().parent


@dataclass
class PostgresqlServer:
    """A server in a folder of its own, on a free port of loopback; it trusts every client."""

    programs: Path
    folder: Path
    port: int
    _numbers: "count[int]" = field(default_factory=count)

    @classmethod
    def create(cls, programs: Path) -> "PostgresqlServer":
        """A server that runs; `remove` ends it."""
        # Not pytest's folder, into which another user must not look.
        folder = Path(tempfile.mkdtemp(prefix="prunus-postgresql-"))
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port: int = free.getsockname()[1]
        server = cls(programs, folder, port)
        if os.geteuid() == 0:
            user = pwd.getpwnam("postgres")
            os.chown(folder, user.pw_uid, user.pw_gid)
        server._run(
            "initdb", "--pgdata", str(server.data), "--username", ADMINISTRATOR, "--auth=trust",
            "--encoding=UTF8", "--locale=C", "--no-sync",
        )  # fmt: skip
        server.start()
        return server

    @property
    def data(self) -> Path:
        """Where the cluster is."""
        return self.folder / "data"

    def url(self, database: str) -> str:
        """A database's address."""
        return f"postgresql://{ADMINISTRATOR}@127.0.0.1:{self.port}/{database}"

    def start(self) -> None:
        """Start it, and wait until it answers."""
        # Only this machine's power could make a difference, and tests do not cut it.
        options = f"-p {self.port} -k {self.folder} -c listen_addresses=127.0.0.1 -c fsync=off"
        self._run(
            "pg_ctl", "start", "--pgdata", str(self.data), "--wait", "--timeout", str(START_S),
            "--log", str(self.folder / "log"), "--options", options,
        )  # fmt: skip

    def stop(self, mode: str = "immediate") -> None:
        """Stop it: `immediate` breaks every connection as a crash does."""
        self._run("pg_ctl", "stop", "--pgdata", str(self.data), "--mode", mode, "--wait")

    def execute(self, statement: str, database: str = "postgres") -> list[Any]:
        """Run a statement outside a transaction; its rows, if it has any."""
        with psycopg.connect(self.url(database), autocommit=True) as connection:
            cursor = connection.execute(statement.encode())
            return cursor.fetchall() if cursor.description else []

    def new_database(self) -> str:
        """The address of a database with nothing in it."""
        name = f"prunus_{next(self._numbers)}"
        self.execute(f"CREATE DATABASE {name} TEMPLATE template0")
        return self.url(name)

    def remove(self) -> None:
        """Stop it and delete its folder."""
        try:
            self.stop()
        finally:
            shutil.rmtree(self.folder)

    def _run(self, program: str, *arguments: str) -> None:
        other: dict[str, Any] = {}
        if os.geteuid() == 0:
            user = pwd.getpwnam("postgres")
            other = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        # Output goes to a file: the server keeps it open, and a pipe would never end.
        with (self.folder / f"{program}.out").open("wb") as output:
            done = subprocess.run(
                [self.programs / program, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                stdout=output, stderr=subprocess.STDOUT, check=False, **other,
            )  # fmt: skip
        told = (self.folder / f"{program}.out").read_text()
        assert done.returncode == 0, f"{program}: {told}"
