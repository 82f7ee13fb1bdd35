"""Mutants run: in memory, two at a time. No file of the project is written."""

import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
_NO_SUCH_TEST: Final = 4
"""Pytest's codes. Every other one is what a mutant comes to: a test fails, its file cannot even be
read, or all of it breaks down."""


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
    patience_s = PATIENCE * sum(tests.values()) + PATIENCE_S
    with tempfile.TemporaryDirectory(prefix="prunus-mutant-") as folder:
        text = Path(folder, "text.py")
        text.write_text(mutant.text(), encoding="utf-8")
        own = {
            "MUTANT_SOURCE": str(mutant.source),
            "MUTANT_TEXT": str(text),
            "PYTHONPATH": os.pathsep.join((str(SITE), str(REPOSITORY))),
        }
        given = {**environment(interpreted=interpreted), **own}
        code = _pytest(tests, Path(folder), given, patience_s)
        if code == _NO_SUCH_TEST:
            # Cases are named after values, which a mutant may change: then all of their functions.
            functions = dict.fromkeys(name.partition("[")[0] for name in tests)
            code = _pytest(functions, Path(folder), given, patience_s)
        if code == _NO_SUCH_TEST:
            # Their file cannot be read, which is the mutant's doing if without it they pass.
            unchanged = environment(interpreted=interpreted)
            if _pytest(functions, Path(folder), unchanged, math.inf) != _ALL_PASSED:
                raise RuntimeError(f"{sorted(functions)} fail without a mutant")
    if code is None:
        return ENDLESS
    return SURVIVED if code == _ALL_PASSED else NOTICED


def _pytest(
    names: Iterable[str], folder: Path, given: dict[str, str], patience_s: float
) -> int | None:
    """What it ends with; None where that takes too long."""
    listed = folder / "tests.txt"
    listed.write_text("\n".join(names))
    process = subprocess.Popen(
        [sys.executable, "-m", "pytest", "-x", f"@{listed}"],
        cwd=REPOSITORY,
        env=given,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        return process.wait(None if math.isinf(patience_s) else patience_s)
    except subprocess.TimeoutExpired:
        # Whatever its tests have started goes too.
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None
