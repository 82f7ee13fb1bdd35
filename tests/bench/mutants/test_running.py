"""Mutants are noticed or not, in memory, and the file stays as it is."""

from pathlib import Path

import pytest

from bench.mutants.choice import chosen_tests
from bench.mutants.outcomes import (
    ENDLESS,
    NOTICED,
    SURVIVED,
    UNTESTED,
    Outcome,
    explained,
    keep,
    read,
)
from bench.mutants.rooms import REPOSITORY, ROOMS, is_compiled, mirror_of, sources_of
from bench.mutants.running import run
from bench.mutants.sample import Mutant, mutants_of

SOURCE = REPOSITORY / "solver" / "problem" / "retreats.py"


def mutant(operator: str, before: str) -> Mutant:
    """The first mutant of an operator in the first line that begins so."""
    lines = SOURCE.read_text().splitlines()
    return next(
        one
        for one in mutants_of(SOURCE)
        if one.operator == operator and lines[one.line - 1].strip().startswith(before)
    )


def test_a_mutant_is_noticed_and_its_file_stays_as_it_is(tmp_path: Path) -> None:
    seen = mutant("ReplaceBinaryOperator_Add_Sub", "return even_retreats(options, max(LOOKED_AT")
    before = SOURCE.read_bytes()
    (outcome,) = run([seen], tmp_path)
    assert SOURCE.read_bytes() == before
    assert outcome.verdict == NOTICED
    assert outcome.tests >= 1
    assert not outcome.lives
    keep(tmp_path / "kept.jsonl", outcome)
    assert read(tmp_path / "kept.jsonl") == [outcome]


def test_slow_tests_are_left_out_and_the_quickest_come_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tests = tmp_path / "test_it.py"
    tests.write_text(
        "import time\n"
        "def test_quick(): pass\n"
        "def test_slow(): time.sleep(5)\n"
        "def test_failing(): assert False\n"
    )
    monkeypatch.setattr("bench.mutants.choice.MOST_TEST_S", 0.5)
    chosen = chosen_tests((tests,), interpreted=False, kept=tmp_path)
    assert [name.rpartition("::")[2] for name in chosen] == ["test_quick"]


def test_the_living_may_be_explained(tmp_path: Path) -> None:
    one, other = (
        Outcome("a.py", "AddNot", 0, 1, before, "pass", SURVIVED, 1, 0.0)
        for before in ("f()", "g()")
    )
    file = tmp_path / "explained.toml"
    file.write_text(
        '[[mutant]]\nsource = "a.py"\nbefore = "f()"\nafter = "pass"\nwhy = "it only warms up"\n'
    )
    assert explained([one, other], file) == {one: "it only warms up"}
    assert explained([one, other]) == {}


def test_what_lives() -> None:
    verdicts = {NOTICED: False, ENDLESS: False, SURVIVED: True, UNTESTED: True}
    for verdict, lives in verdicts.items():
        assert Outcome("a.py", "AddNot", 0, 1, "a", "b", verdict, 0, 0.0).lives is lives


def test_rooms_are_there_and_have_tests() -> None:
    for room in ROOMS:
        sources = sources_of(room)
        assert sources
        assert all(map(mirror_of, sources))
    kernels = REPOSITORY / "solver" / "approach" / "arcs" / "roots.py"
    assert is_compiled(kernels)
    assert is_compiled(REPOSITORY / "solver" / "approach" / "tolerances.py")
    assert not is_compiled(REPOSITORY / "solver" / "verification" / "verify.py")
