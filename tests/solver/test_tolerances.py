"""Tolerances: none bare, none unused, each in the room that it belongs to, with unit and reason."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import solver

SOLVER = Path(solver.__file__).parent
FILES = sorted(SOLVER.rglob("tolerances.py"))

# What says in words what a number without a unit in brackets is.
WORDS = re.compile(r"\b(shares?|relative|factor|times|multiples|cosine|sine|sin|angle)\b", re.I)

SMALL = 1e-3

# Small numbers that are no tolerances, by file.
NO_TOLERANCES = {
    "problem/options.py": "defaults and ranges, which the options' own table documents",
    "warm_up.py": "the standard deviation of a target that is made up",
}


def module_of(file: Path) -> str:
    return ".".join(file.relative_to(SOLVER.parent).with_suffix("").parts)


def constants(file: Path) -> Iterator[tuple[str, ast.expr, str]]:
    """Name, value and docstring of every public constant."""
    body = ast.parse(file.read_text(encoding="utf-8")).body
    for k, node in enumerate(body):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            assert node.value is not None
            after = body[k + 1] if k + 1 < len(body) else None
            documented = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            text = str(after.value.value) if documented else ""  # type: ignore[union-attr]
            yield node.target.id, node.value, text


def users(file: Path) -> dict[str, set[str]]:
    """For every name, what lies beside a file and imports it there, or below there."""
    found: dict[str, set[str]] = {}
    for other in file.parent.rglob("*.py"):
        for node in ast.walk(ast.parse(other.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module == module_of(file):
                for alias in node.names:
                    found.setdefault(alias.name, set()).add(other.relative_to(file.parent).parts[0])
    return found


@pytest.mark.parametrize("file", FILES, ids=module_of)
def test_every_constant_has_its_unit_and_its_reason(file: Path) -> None:
    for name, value, text in constants(file):
        assert name.isupper(), name
        assert text, f"{name} is not documented"
        whole = isinstance(value, ast.Constant) and isinstance(value.value, int)
        assert whole or "[" in text or WORDS.search(text), f"{name} has no unit"


@pytest.mark.parametrize("file", FILES, ids=module_of)
def test_every_constant_is_used_where_it_stands(file: Path) -> None:
    """By its own room; where rooms below share it, by two of them."""
    used = users(file)
    for name, _, _ in constants(file):
        rooms = used.get(name, set())
        own = file.parent != SOLVER and any(room.endswith(".py") for room in rooms)
        assert own or len(rooms) >= 2, f"{name} is used by {sorted(rooms)} only"


def test_no_small_number_is_bare() -> None:
    bare = {}
    for file in SOLVER.rglob("*.py"):
        place = file.relative_to(SOLVER).as_posix()
        if file.name != "tolerances.py":
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                small = isinstance(node, ast.Constant) and isinstance(node.value, float)
                if small and 0 < abs(node.value) < SMALL:  # type: ignore[attr-defined]
                    bare[place] = node.lineno  # type: ignore[attr-defined]
    assert bare.keys() == NO_TOLERANCES.keys(), bare
