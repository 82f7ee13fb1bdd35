"""Back up under load, restore, start: what was answered before is there."""

import concurrent.futures
import subprocess
import sys
from pathlib import Path
from typing import Any

from tests.app.conftest import REPOSITORY, running_server


def backup(output: Path, data_dir: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "app", "backup", str(output), "--data-dir", str(data_dir)]
    return subprocess.run(
        command, cwd=REPOSITORY, capture_output=True, text=True, timeout=60, check=False
    )


def test_backed_up_under_load_and_restored(tmp_path: Path, request_body: dict[str, Any]) -> None:
    output = tmp_path / "restored" / "prunus.sqlite3"
    output.parent.mkdir()
    with (
        running_server(tmp_path / "data") as server,
        concurrent.futures.ThreadPoolExecutor(1) as executor,
    ):

        def post() -> Any:
            return server.client.post("/v1/plans", json=request_body)

        answered = [post() for _ in range(3)]
        running = executor.submit(backup, output, server.data_dir)
        after = 0
        while not running.done():
            assert post().status_code == 201
            after += 1
        done = running.result()
        assert done.returncode == 0, done.stderr
        assert after
        again = backup(output, server.data_dir)
        assert again.returncode == 1
        assert "exists already" in again.stderr
        assert [file.name for file in output.parent.iterdir()] == ["prunus.sqlite3"]
    with running_server(output.parent) as server:
        for answer in answered:
            assert server.client.get(answer.headers["location"]).content == answer.content


def test_nothing_to_back_up(tmp_path: Path) -> None:
    done = backup(tmp_path / "copy", tmp_path / "nowhere")
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "copy").exists()
