import ast
import doctest
import subprocess
import sys
from pathlib import Path

import pytest

import solver

STUB = Path(solver.__file__ or "").with_suffix(".pyi")


def test_documented_example_runs() -> None:
    result = doctest.testmod(solver)
    assert result.attempted >= 4
    assert result.failed == 0


def test_every_public_name_is_there_and_documented() -> None:
    for name in solver.__all__:
        value = getattr(solver, name)
        assert value.__doc__ or not callable(value), name
        assert name in dir(solver)
    assert list(solver.__all__) == sorted(solver.__all__)
    with pytest.raises(AttributeError, match="nothing"):
        _ = solver.nothing  # type: ignore[attr-defined]


def test_type_checkers_are_told_the_same_names() -> None:
    stub = ast.parse(STUB.read_text(encoding="utf-8"))
    told = {
        (node.module, entry.name)
        for node in ast.walk(stub)
        if isinstance(node, ast.ImportFrom)
        for entry in node.names
    }
    assert {name for _, name in told} == set(solver.__all__)
    for module, name in told:
        assert getattr(solver, name) is getattr(sys.modules[str(module)], name)


@pytest.mark.parametrize(
    "module", ["hardware.simulator.program", "hardware.worker.program", "app.commands.cli"]
)
def test_what_only_needs_a_robots_model_imports_no_compiler(module: str) -> None:
    program = f"import sys, {module}; print({{'numba', 'casadi', 'scipy'}} & set(sys.modules))"
    command = [sys.executable, "-c", program]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed == "set()\n"


@pytest.mark.parametrize("house", ["app", "hardware"])
def test_other_houses_use_public_names_alone(house: str) -> None:
    """Comparisons are a room with names of its own, and set-up compiles everything there is."""
    rooms = ("solver.comparison", "solver.warm_up")
    used = {
        node.module
        for file in (STUB.parents[1] / house).rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("solver.")
    }
    assert {module for module in used if not str(module).startswith(rooms)} == set()
