import re
import shutil
import subprocess

import pytest

from tests.app.conftest import REPOSITORY

DEPLOY = REPOSITORY / "deploy"


def test_container_file_copies_what_exists() -> None:
    text = (DEPLOY / "Containerfile").read_text()
    copied = [line.split()[1:-1] for line in text.splitlines() if line.startswith("COPY ")]
    names = [name for names in copied for name in names]
    assert len(names) >= 5
    assert all((REPOSITORY / name).exists() for name in names)
    assert re.search(r"^USER (?!root)", text, re.MULTILINE)
    assert "/readyz" in text


@pytest.mark.skipif(not shutil.which("systemd-analyze"), reason="systemd is not installed")
@pytest.mark.parametrize("unit", ["prunus.service", "prunus-worker@.service"])
def test_units_are_valid(unit: str) -> None:
    command = ["systemd-analyze", "verify", "--man=no", str(DEPLOY / unit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    # The programs are not installed where the units say.
    lines = [line for line in done.stderr.splitlines() if "/opt/prunus" not in line]
    assert [line for line in lines if unit.partition(".")[0].rstrip("@") in line] == []
