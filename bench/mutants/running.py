"""Mutants run: in memory, two at a time. No file of the project is written."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from bench.mutants.choice import chosen_tests, environment
from bench.mutants.outcomes import ENDLESS, NOTICED, SURVIVED, UNTESTED, Outcome, outcome_of
from bench.mutants.rooms import REPOSITORY, is_compiled, mirror_of
from bench.mutants.sample import Mutant

AT_A_TIME: Final = 2
SITE: Final = Path(__file__).with_name("site")

PATIENCE: Final = 3.0
PATIENCE_S: Final = 15.0
"""A mutant whose tests take so much longer than they do, and so long to start, is endless."""

_ALL_PASSED: Final = 0
_NOTICED: Final = (1, 2)
"""Pytest's codes of what a mutant comes to: a test fails, or its file cannot even be read."""


def run(mutants: Sequence[Mutant], kept: Path) -> Iterator[Outcome]:
    """What becomes of each, as it is known.

    Args:
        mutants: whose tests pass on what is not changed.
        kept: the folder for how long tests take.
    """
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        # Mutants of a file share its tests, whose times are to be found once.
        whose = {(mirror_of(one.source), is_compiled(one.source)) for one in mutants}
        found = pool.map(
            lambda key: chosen_tests(key[0], interpreted=key[1], kept=kept), sorted(whose)
        )
        chosen = dict(zip(sorted(whose), found, strict=True))
        yield from pool.map(lambda mutant: _outcome(mutant, chosen), mutants)


def _outcome(
    mutant: Mutant, chosen: Mapping[tuple[tuple[Path, ...], bool], dict[str, float]]
) -> Outcome:
    interpreted = is_compiled(mutant.source)
    tests = chosen[mirror_of(mutant.source), interpreted]
    if not tests:
        return outcome_of(mutant, UNTESTED, 0, 0.0)
    began = time.monotonic()
    verdict = _verdict(mutant, tests, interpreted=interpreted)
    return outcome_of(mutant, verdict, len(tests), time.monotonic() - began)


def _verdict(mutant: Mutant, tests: dict[str, float], *, interpreted: bool) -> str:
    with tempfile.TemporaryDirectory(prefix="prunus-mutant-") as folder:
        text, names = Path(folder, "text.py"), Path(folder, "tests.txt")
        text.write_text(mutant.text(), encoding="utf-8")
        names.write_text("\n".join(tests))
        own = {
            "MUTANT_SOURCE": str(mutant.source),
            "MUTANT_TEXT": str(text),
            "PYTHONPATH": os.pathsep.join((str(SITE), str(REPOSITORY))),
        }
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", "-x", f"@{names}"],
            cwd=REPOSITORY,
            env={**environment(interpreted=interpreted), **own},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        try:
            told, _ = process.communicate(timeout=PATIENCE * sum(tests.values()) + PATIENCE_S)
        except subprocess.TimeoutExpired:
            # Whatever its tests have started goes too.
            os.killpg(process.pid, 9)
            process.communicate()
            return ENDLESS
    if process.returncode == _ALL_PASSED:
        return SURVIVED
    if process.returncode not in _NOTICED:
        raise RuntimeError(f"pytest ended with {process.returncode}: {told[-2000:]}")
    return NOTICED
