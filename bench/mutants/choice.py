"""Which tests are run on a mutant: the quickest that mirror its file, for as long as there is time.

How long each takes is found once, and kept until the tests change.
"""

import contextlib
import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Final

from bench.mutants.rooms import REPOSITORY, digest_of
from bench.mutants.watch import DURATIONS, MOST_S

MOST_TEST_S: Final = 6.0
"""A test that takes longer is not run on mutants."""

MOST_TESTS_S: Final = 9.0
"""The tests of one mutant together: with two at a time 150 mutants take a quarter of an hour."""

MOST_FOLDER_S: Final = 600.0
"""Until it is known how long the tests of a file or folder take; what comes later is left out."""


def environment(*, interpreted: bool) -> dict[str, str]:
    """Of a test run: kernels interpreted or not, no plugins of pytest but our own."""
    own = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    if interpreted:
        own["NUMBA_DISABLE_JIT"] = "1"
    return {**os.environ, **own}


def chosen_tests(tests: tuple[Path, ...], *, interpreted: bool, kept: Path) -> dict[str, float]:
    """The tests to run, with how long each takes [s], by its id.

    Of every function the quickest case, then of every one the next, for as long as there is time.

    Args:
        tests: files of tests.
        interpreted: kernels are.
        kept: the folder for what was measured before.
    """
    chosen: dict[str, float] = {}
    measured = _durations(tests, interpreted=interpreted, kept=kept)
    cases: Counter[str] = Counter()
    ranked = []
    for name, duration in sorted(measured.items(), key=lambda entry: entry[1]):
        function = name.partition("[")[0]
        ranked.append((cases[function], duration, name))
        cases[function] += 1
    for _, duration, name in sorted(ranked):
        if duration <= MOST_TEST_S and sum(chosen.values()) + duration <= MOST_TESTS_S:
            chosen[name] = duration
    return chosen


def _durations(tests: tuple[Path, ...], *, interpreted: bool, kept: Path) -> dict[str, float]:
    known = kept / f"{digest_of(tests, str(interpreted))}.json"
    if not known.exists():
        kept.mkdir(parents=True, exist_ok=True)
        _measure(tests, known, interpreted=interpreted)
    durations: dict[str, float] = json.loads(known.read_text())
    return durations


def _measure(files: tuple[Path, ...], result: Path, *, interpreted: bool) -> None:
    partial = result.with_suffix(".partial")
    command = [sys.executable, "-m", "pytest", "-p", "bench.mutants.watch", *map(str, files)]
    watched = {MOST_S: str(MOST_TEST_S), DURATIONS: str(partial)}
    partial.write_text("{}")
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(
            command,
            cwd=REPOSITORY,
            env={**environment(interpreted=interpreted), **watched},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=MOST_FOLDER_S,
            check=False,
        )
    if not json.loads(partial.read_text()):
        raise RuntimeError(f"none of the tests of {', '.join(map(str, files))} has run")
    partial.rename(result)
