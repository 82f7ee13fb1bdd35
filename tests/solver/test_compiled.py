"""Compiled kernels are kept under a name that changes with everything compiled into them."""

import ast
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

import solver
from solver import compiled

SOLVER = Path(solver.__file__).parent
DECORATORS = {"kernel", "minimum", "inlined"}

KERNEL = """from solver.compiled import kernel
from solver.new.inner.constants import STEP

@kernel
def stepped(x):
    return x + STEP
"""


def syntax(file: Path) -> Iterator[ast.AST]:
    return ast.walk(ast.parse(file.read_text(encoding="utf-8")))


def kernel_modules() -> list[Path]:
    """Files with a function that Numba compiles."""
    return [
        file
        for file in SOLVER.rglob("*.py")
        if any(
            isinstance(node, ast.FunctionDef)
            and any(isinstance(d, ast.Name) and d.id in DECORATORS for d in node.decorator_list)
            for node in syntax(file)
        )
    ]


def imported(file: Path) -> Iterator[Path]:
    """The files of ours that a file imports from, however it does."""
    for node in syntax(file):
        names = []
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file} imports relatively"
            names = [node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in names:
            module = SOLVER.parent / (name.replace(".", "/") + ".py")
            if name.startswith("solver.") and module.exists():
                yield module


def test_every_kernel_names_the_cache_and_so_does_all_that_it_imports() -> None:
    sources = set(compiled.kernel_sources())
    assert len(kernel_modules()) >= 25
    assert set(kernel_modules()) <= sources
    for file in sources:
        assert set(imported(file)) <= sources, file


def test_what_no_kernel_uses_does_not_name_the_cache() -> None:
    sources = {file.relative_to(SOLVER).as_posix() for file in compiled.kernel_sources()}
    assert sources.isdisjoint({"solving/solve.py", "methods/nlp/tolerances.py", "warm_up.py"})


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """The sources elsewhere, with a kernel and a constant in new folders."""
    copy = tmp_path / "solver"
    shutil.copytree(SOLVER, copy, ignore=shutil.ignore_patterns("__pycache__"))
    room = copy / "new" / "inner"
    room.mkdir(parents=True)
    (room / "stepping.py").write_text(KERNEL)
    (room / "constants.py").write_text("STEP = 1.0\n")
    return copy


def test_kernels_are_found_wherever_they_lie(copied: Path) -> None:
    found = {file.relative_to(copied).as_posix() for file in compiled.kernel_sources(copied)}
    here = {file.relative_to(SOLVER).as_posix() for file in compiled.kernel_sources()}
    assert found - here == {"new/inner/stepping.py", "new/inner/constants.py"}


@pytest.mark.parametrize(
    "changed",
    ["new/inner/stepping.py", "new/inner/constants.py", "approach/arcs/tolerances.py"],
)
def test_a_changed_source_changes_the_folder(copied: Path, changed: str) -> None:
    before = compiled.cache_folder(copied)
    assert compiled.cache_folder(copied) == before != compiled.cache_folder()
    with (copied / changed).open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert compiled.cache_folder(copied) != before
    assert compiled.cache_folder(copied).parent == before.parent


def test_the_cache_follows_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert compiled.cache_folder().is_relative_to(tmp_path)
