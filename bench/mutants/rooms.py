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


def mirror_of(source: Path) -> tuple[Path, ...]:
    """The test files that mirror a source: named after it, or without one all of their folder."""
    folder = REPOSITORY / "tests" / source.relative_to(REPOSITORY).parent
    while not list(folder.glob("test_*.py")):
        folder = folder.parent
    own = (*folder.glob(f"test_{source.stem}.py"), *folder.glob(f"test_{source.stem}_*.py"))
    return tuple(sorted(own or folder.glob("test_*.py")))


def is_compiled(source: Path) -> bool:
    """Whether kernels are made of a source; tests see its mutants only where they are interpreted.

    A kernel that is kept on disk has in it what it was compiled from.
    """
    return source in _compiled()


@cache
def _compiled() -> frozenset[Path]:
    return frozenset(kernel_sources())


def digest_of(files: tuple[Path, ...], more: str = "") -> str:
    """A name for what files have in them."""
    digest = hashlib.sha256(more.encode())
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]
