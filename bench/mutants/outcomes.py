"""What became of mutants: kept line by line, so that a run goes on where it was ended."""

import difflib
import json
import tomllib
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from bench.mutants.rooms import REPOSITORY
from bench.mutants.sample import Mutant

EXPLAINED: Final = Path(__file__).with_name("explained.toml")

NOTICED: Final = "noticed"
ENDLESS: Final = "endless"
SURVIVED: Final = "survived"
UNTESTED: Final = "untested"
"""A test failed; none ended in time; all passed; there was none that is quick enough."""


@dataclass(frozen=True)
class Outcome:
    """What became of one mutant.

    Attributes:
        source: its file, from the repository's folder.
        operator: what changed it.
        occurrence: where, from 0.
        line: where, from 1.
        before: the changed lines as they are.
        after: and as they were changed.
        verdict: NOTICED, ENDLESS, SURVIVED or UNTESTED.
        tests: how many tests were to be run on it.
        elapsed_s: how long they ran [s].
    """

    source: str
    operator: str
    occurrence: int
    line: int
    before: str
    after: str
    verdict: str
    tests: int
    elapsed_s: float

    @property
    def lives(self) -> bool:
        """Whether no test noticed it."""
        return self.verdict in (SURVIVED, UNTESTED)


def outcome_of(mutant: Mutant, verdict: str, tests: int, elapsed_s: float) -> Outcome:
    """An outcome with the lines that were changed."""
    old, new = mutant.source.read_text(encoding="utf-8"), mutant.text()
    lines = list(difflib.ndiff(old.splitlines(), new.splitlines()))
    before, after = (
        "\n".join(line[2:].strip() for line in lines if line.startswith(mark))
        for mark in ("-", "+")
    )
    source = str(mutant.source.relative_to(REPOSITORY))
    return Outcome(
        source, mutant.operator, mutant.occurrence, mutant.line, before, after, verdict, tests,
        round(elapsed_s, 2),
    )  # fmt: skip


def read(file: Path) -> list[Outcome]:
    """The outcomes kept in a file; none where it is not there."""
    if not file.exists():
        return []
    return [Outcome(**json.loads(line)) for line in file.read_text().splitlines()]


def keep(file: Path, outcome: Outcome) -> None:
    """Add one."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a") as kept:
        kept.write(json.dumps(asdict(outcome)) + "\n")


def explained(outcomes: Iterable[Outcome], file: Path = EXPLAINED) -> dict[Outcome, str]:
    """Why those stay that no test notices, where it is known."""
    rows = tomllib.loads(file.read_text(encoding="utf-8")).get("mutant", [])
    known = {(row["source"], row["before"], row["after"]): str(row["why"]) for row in rows}
    found = ((one, known.get((one.source, one.before, one.after))) for one in outcomes)
    return {one: why for one, why in found if why is not None}
