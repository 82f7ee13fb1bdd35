"""The programs that README and docs/hardware.md tell people to start are started as written."""

import contextlib
import selectors
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.app.conftest import REPOSITORY, running_server, wait_until
from tests.docs.test_documents import ROOT, fences

# Robot time does not wait for a busy machine.
pytestmark = pytest.mark.alone

START_S = 60


def commands(document: str) -> dict[str, list[str]]:
    """The shell commands that start one of Prunus's programs, by its name, without what is ours."""
    found = {}
    for text in fences(document, "sh"):
        words = shlex.split(text)
        if words[0] == ".venv/bin/prunus":
            found[words[1]] = words[1:]
    return found


@contextlib.contextmanager
def started(words: list[str]) -> Iterator["subprocess.Popen[str]"]:
    with subprocess.Popen(
        [sys.executable, "-m", "app", *words],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.wait(30)


def first_line(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        assert selector.select(START_S), "it said nothing"
    return process.stdout.readline().strip()


@pytest.mark.parametrize("document", ["README.md", "docs/hardware.md"])
def test_servo_bus_and_worker_start_as_written(tmp_path: Path, document: str) -> None:
    """Only addresses and folders are replaced by this test's own."""
    written = commands(document)
    link = tmp_path / "bus"
    bus = [word.replace("/tmp/prunus-bus", str(link)) for word in written["servo-bus"]]
    assert str(link) in bus
    with running_server(tmp_path / "data") as server, started(bus) as servos:
        assert first_line(servos).startswith("/dev/pts/")
        worker = [
            word.replace("/tmp/prunus-bus", str(link)).replace("http://127.0.0.1:8000", server.url)
            for word in written["worker"]
        ]
        assert server.url in worker
        with started([*worker, "--data-dir", str(tmp_path / "worker")]):
            state = "/v1/robots/tabletop-sim/state"
            wait_until(lambda: server.client.get(state).json()["connected"], START_S)
            if document == "README.md":
                printed = run_client(server.url)
                assert printed[0] == "completed"
                for number, line in enumerate(printed[1:], start=1):
                    name, status, millimetres, unit = line.split()
                    assert (name, status, unit) == (str(number), "done", "mm")
                    assert 0 < float(millimetres) < 3
                assert len(printed) == 6


def run_client(url: str) -> list[str]:
    (client,) = [text for text in fences("README.md", "python") if "httpx2" in text]
    assert "http://127.0.0.1:8000" in client
    finished = subprocess.run(
        [sys.executable, "-c", client.replace("http://127.0.0.1:8000", url)],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    return finished.stdout.splitlines()


def test_the_service_starts_as_written(tmp_path: Path) -> None:
    words = commands("README.md")["serve"]
    assert words == ["serve", "--port", "8000"]
    with started([*words[:-1], "0", "--data-dir", str(tmp_path)]) as service:
        assert first_line(service).startswith("Prunus listens on http://127.0.0.1:")


def test_the_simulated_buss_document_starts_it(tmp_path: Path) -> None:
    words = commands("docs/simulated_bus.md")["servo-bus"]
    link = tmp_path / "bus"
    with started([word.replace("/tmp/prunus-bus", str(link)) for word in words]) as servos:
        assert first_line(servos) == str(link.readlink())
