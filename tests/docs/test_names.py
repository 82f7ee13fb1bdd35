"""Documents name files, folders and modules that are there, and no file names a registry's host."""

import pkgutil
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

_FOLDERS = "app|bench|deploy|docs|hardware|openapi|requirements|scripts|solver|tests"
PATH = re.compile(rf"(?:{_FOLDERS})(?:/[\w.@-]*)*")
FILE = re.compile(r"[\w.-]+\.(?:csv|lock|md|py|service|sh|toml)|Makefile")
NOT_OURS = {"prunus.sqlite3.lock", "solver.status", "solver.elapsed_s"}
"""Look like files or modules of ours: a lock beside the database, fields of answers."""
DOTTED = re.compile(r"(?:app|bench|hardware|scripts|solver)(?:\.\w+)+")

# Joined here, so that this file names none.
REGISTRIES = [
    ".".join(parts)
    for parts in (
        ("pypi", "org"),
        ("pythonhosted", "org"),
        ("anaconda", "org"),
        ("anaconda", "com"),
        ("npmjs", "org"),
        ("npmjs", "com"),
        ("npmmirror", "com"),
        ("yarnpkg", "com"),
        ("jsr", "io"),
        ("unpkg", "com"),
        ("esm", "sh"),
        ("jsdelivr", "net"),
        ("crates", "io"),
        ("rubygems", "org"),
        ("packagist", "org"),
        ("maven", "org"),
        ("proxy", "golang", "org"),
        ("deb", "debian", "org"),
        ("security", "debian", "org"),
        ("ftp", "debian", "org"),
        ("snapshot", "debian", "org"),
        ("archive", "ubuntu", "com"),
        ("security", "ubuntu", "com"),
        ("ports", "ubuntu", "com"),
        ("alpinelinux", "org"),
    )
]


def tracked() -> list[str]:
    listed = subprocess.run(["git", "ls-files", "-z"], capture_output=True, check=True, cwd=ROOT)
    return [name for name in listed.stdout.decode().split("\0") if (ROOT / name).is_file()]


TRACKED = tracked()
# What was true of a version that is out stays as it was written.
DOCUMENTS = [name for name in TRACKED if name.endswith(".md") and name != "CHANGELOG.md"]


def named(document: str) -> list[str]:
    """What stands between backticks in a document, outside its blocks of code."""
    text = re.sub(r"^```.*?^```", "", (ROOT / document).read_text("utf-8"), flags=re.M | re.S)
    return re.findall(r"`([^`\n]+)`", text)


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_paths_that_are_there(document: str) -> None:
    folders = {f"{parent}" for name in TRACKED for parent in Path(name).parents}
    for name in named(document):
        if PATH.fullmatch(name):
            assert name in TRACKED or name.rstrip("/") in folders, name


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_files_that_are_there(document: str) -> None:
    files = {Path(name).name for name in TRACKED} | NOT_OURS
    for name in named(document):
        if FILE.fullmatch(name):
            assert name in files, name


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_modules_that_are_there(document: str) -> None:
    for name in named(document):
        if DOTTED.fullmatch(name) and not FILE.fullmatch(name) and name not in NOT_OURS:
            pkgutil.resolve_name(name)


def test_no_file_names_the_host_of_a_package_registry() -> None:
    host = re.compile(
        rf"(?<![\w-])({'|'.join(map(re.escape, REGISTRIES))})(?![\w-])", re.IGNORECASE
    )
    assert host.search(f"https://{REGISTRIES[0]}/simple")
    assert host.search(f"files.{REGISTRIES[1]}")
    for name in TRACKED:
        try:
            text = (ROOT / name).read_text("utf-8")
        except UnicodeDecodeError:
            continue  # a picture
        found = host.search(text)
        assert not found, f"{name}: {found}"
