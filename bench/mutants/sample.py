"""Which mutants are made of a room: a seeded few of all that its files have."""

import random
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code

from bench.mutants.operators import operators

_GUARD: Final = re.compile(r"\b(frozen|strict)=$")
"""Against mistakes of who writes the code: nothing that runs depends on it."""


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Attributes:
        source: the file.
        operator: name of what changes it.
        occurrence: which of the places where it can, from 0.
        line: where that is, from 1.
    """

    source: Path
    operator: str
    occurrence: int
    line: int

    def text(self) -> str:
        """The file's text with the change."""
        code = self.source.read_text(encoding="utf-8")
        changed: str | None = mutate_code(code, operators()[self.operator], self.occurrence)
        assert changed is not None, "places are counted as they are changed"
        return changed


def mutants_of(source: Path) -> list[Mutant]:
    """All mutants of a file."""
    code = source.read_text(encoding="utf-8")
    tree, lines = get_ast(code), code.splitlines()
    found: list[Mutant] = []
    for name, operator in operators().items():
        places = (place for node in ast_nodes(tree) for place in operator.mutation_positions(node))
        found += [
            Mutant(source, name, k, line)
            for k, ((line, column), _) in enumerate(places)
            if not _GUARD.search(lines[line - 1][:column])
        ]
    return found


def sampled(sources: Iterable[Path], count: int, seed: int) -> list[Mutant]:
    """So many mutants of some files, drawn by line first: long formulas have most of the places."""
    by_line: dict[tuple[Path, int], list[Mutant]] = {}
    for source in sources:
        for mutant in mutants_of(source):
            by_line.setdefault((source, mutant.line), []).append(mutant)
    rng = random.Random(seed)
    lines = sorted(by_line)
    drawn = rng.sample(lines, min(count, len(lines)))
    return [rng.choice(by_line[line]) for line in drawn]
