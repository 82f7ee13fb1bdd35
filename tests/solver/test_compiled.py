"""Compiled kernels are kept under a name that changes with everything compiled into them."""

import ast
from pathlib import Path

import pytest

import solver
from solver import compiled

ROOT = Path(solver.__file__).parent

# Modules of which kernels use nothing at run time: types, and errors raised outside kernels.
NOT_COMPILED_IN = {"solver.robots.model", "solver.robots.rigid", "solver.exceptions"}


def kernel_modules() -> list[Path]:
    return [file for file in ROOT.rglob("*.py") if "@kernel" in file.read_text(encoding="utf-8")]


def test_kernels_use_only_sources_that_name_the_cache() -> None:
    sources = set(compiled.kernel_sources())
    assert len(kernel_modules()) >= 3
    for module in kernel_modules():
        assert module in sources
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("solver."):
                assert node.module is not None
                file = ROOT.parent / (node.module.replace(".", "/") + ".py")
                assert file in sources or node.module in NOT_COMPILED_IN, node.module


def test_a_changed_constant_changes_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = compiled.cache_folder()
    assert compiled.cache_folder() == before
    changed = tmp_path / "tolerances.py"
    changed.write_text("JOINT_RATE_RAD_M = 1.0\n")
    monkeypatch.setattr(compiled, "kernel_sources", lambda: (changed,))
    assert compiled.cache_folder() != before
    assert compiled.cache_folder().parent == before.parent


def test_the_cache_follows_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert compiled.cache_folder().is_relative_to(tmp_path)
