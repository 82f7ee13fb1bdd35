"""Which mutants are made of a file, and that each is one change of it."""

from pathlib import Path

import pytest

from bench.mutants.operators import LeaveOutStatement, operators
from bench.mutants.sample import Mutant, mutants_of, sampled

CODE = '''"""A file."""


def larger(numbers, least=0.5):
    """Those that are."""
    found = []
    for number in numbers:
        if number > least:
            found.append(number)
    found.sort()
    return found


def counted(numbers):
    total = [0]
    for _ in numbers:
        total[0] += 1
    total[0] = 2 * total[0] - total[0]
    yield total[0]
'''


@pytest.fixture
def source(tmp_path: Path) -> Path:
    file = tmp_path / "larger.py"
    file.write_text(CODE)
    return file


def changes(mutant: Mutant) -> tuple[str, str]:
    """The one line that is changed, before and after."""
    pairs = zip(CODE.splitlines(), mutant.text().splitlines(), strict=True)
    (pair,) = [(a, b) for a, b in pairs if a != b]
    return pair[0].strip(), pair[1].strip()


def test_every_mutant_changes_its_line_and_no_other(source: Path) -> None:
    found = mutants_of(source)
    for mutant in found:
        before, after = changes(mutant)
        assert before == CODE.splitlines()[mutant.line - 1].strip()
        compile(mutant.text(), "larger.py", "exec")
        assert after
    assert {changes(mutant) for mutant in found} >= {
        ("if number > least:", "if number >= least:"),
        ("if number > least:", "if not number > least:"),
        ("found.append(number)", "pass"),
        ("found.sort()", "pass"),
        ("total[0] += 1", "pass"),
        ("total[0] = 2 * total[0] - total[0]", "pass"),
        ("total[0] = 2 * total[0] - total[0]", "total[0] = 2 * total[0] + total[0]"),
        ("yield total[0]", "pass"),
        ("for number in numbers:", "for number in []:"),
        ("def larger(numbers, least=0.5):", "def larger(numbers, least= 1.5):"),
    }
    assert len({(mutant.operator, mutant.occurrence) for mutant in found}) == len(found)


def test_what_later_lines_need_is_not_left_out(source: Path) -> None:
    left_out = {
        changes(mutant)[0]
        for mutant in mutants_of(source)
        if mutant.operator == LeaveOutStatement.__name__
    }
    assert "found = []" not in left_out
    assert "total = [0]" not in left_out
    assert not any(line.startswith("return") for line in left_out)


def test_a_sample_is_seeded_and_has_a_line_once(source: Path) -> None:
    first, again, other = (sampled([source], 6, seed) for seed in (1, 1, 2))
    assert first == again != other
    assert len({mutant.line for mutant in first}) == 6
    every = sampled([source], 1000, 1)
    assert {mutant.line for mutant in every} == {mutant.line for mutant in mutants_of(source)}


def test_operators_are_named_after_themselves() -> None:
    assert all(name.endswith(type(one).__name__) for name, one in operators().items())
