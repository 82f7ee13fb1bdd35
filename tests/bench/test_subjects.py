"""Every subject runs on tiny sets and yields lines that can be written, read and shown."""

import dataclasses
from pathlib import Path

import pytest

from bench.measure import QUANTILES
from bench.page import page
from bench.registry import SUBJECTS, Subject
from bench.results import as_document, read, rows_of, write
from solver.comparison.machine import machine


def test_every_file_has_a_row() -> None:
    folder = Path(__file__).parents[2] / "bench" / "subjects"
    assert {file.stem for file in folder.glob("*.py")} == {*SUBJECTS, "__init__"}


@pytest.mark.parametrize("subject", SUBJECTS.values(), ids=list(SUBJECTS))
def test_a_subject_yields_lines(subject: Subject, tmp_path: Path) -> None:
    rows = subject.measure(True)
    assert rows
    assert len({row.name for row in rows}) == len(rows)
    for row in rows:
        assert row.runs >= (row.value is not None)
        assert (row.wanted == "") == (row.reached is None)
        assert row.value is not None or row.note, "a figure that is missing is explained"
        if row.spread is not None:
            assert list(row.spread) == list(QUANTILES)
            assert list(row.spread.values()) == sorted(row.spread.values())
    write(tmp_path, as_document(subject, rows, machine(), True, 0.0))
    results = read(tmp_path)
    kept = rows_of(results[subject.name])
    assert [dataclasses.astuple(row) for row in kept] == [dataclasses.astuple(row) for row in rows]
    text = page(results)
    assert all(f"| {row.name} |" in text for row in rows)
