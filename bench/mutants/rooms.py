"""The rooms whose mutants are made, a row each, and which tests are to notice them."""

import hashlib
from functools import cache
from pathlib import Path
from typing import Final

from solver.compiled import kernel_sources

REPOSITORY: Final = Path(__file__).parents[2]

ROOMS: Final = (
    "solver/verification",
    "solver/approach",
    "solver/sequencing",
    "solver/methods",
    "hardware/worker",
    "hardware/arm",
)


def sources_of(room: str) -> tuple[Path, ...]:
    """The files of a room, its inner rooms' too, sorted."""
    return tuple(sorted((REPOSITORY / room).rglob("*.py")))


def mirror_of(source: Path) -> Path:
    """The test file that mirrors a source; without one the folder of the tests beside it."""
    inside = source.relative_to(REPOSITORY)
    mirror = REPOSITORY / "tests" / inside.parent / f"test_{source.name}"
    folder = mirror.parent
    while not folder.exists():
        folder = folder.parent
    return mirror if mirror.exists() else folder


def is_compiled(source: Path) -> bool:
    """Whether kernels are made of a source; tests see its mutants only where they are interpreted.

    A kernel that is kept on disk has in it what it was compiled from.
    """
    return source in _compiled()


@cache
def _compiled() -> frozenset[Path]:
    return frozenset(kernel_sources())


def digest_of(files: tuple[Path, ...] | list[Path], more: str = "") -> str:
    """A name for what files have in them."""
    digest = hashlib.sha256(more.encode())
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]
