"""Decisions are written alike, numbered without gaps, and name each other both ways."""

from pathlib import Path

import pytest

from scripts.decisions import FOLDER, index_of, read_decision, read_decisions

HEAD = "# 1. Title\n\n- date: 2026-11-24\n- status: accepted\n- supersedes: nothing\n\nText.\n"


def test_numbers_are_those_of_the_files_without_gaps() -> None:
    decisions = read_decisions()
    assert [decision.number for decision in decisions] == list(range(1, len(decisions) + 1))
    assert [int(decision.file.name[:4]) for decision in decisions] == [
        decision.number for decision in decisions
    ]
    assert {file.name for file in FOLDER.iterdir()} == {
        "README.md",
        *(decision.file.name for decision in decisions),
    }


def test_later_decisions_have_later_dates() -> None:
    dates = [decision.date for decision in read_decisions()]
    assert dates == sorted(dates)


def test_what_supersedes_and_what_is_superseded_name_each_other() -> None:
    named = set()
    naming = set()
    for decision in read_decisions():
        number = decision.file.name[:4]
        for replaced, part in decision.replaces:
            assert replaced < number
            named.add((number, replaced, part))
        if decision.superseded_by:
            by, part = decision.superseded_by
            naming.add((by, number, part))
    assert named == naming
    assert named


def test_the_index_has_a_row_for_each() -> None:
    decisions = read_decisions()
    rows = index_of(decisions).splitlines()[2:]
    for decision, row in zip(decisions, rows, strict=True):
        assert f"({decision.file.name})" in row
        assert f"| {decision.title} | {decision.date} | {decision.status} |" in row


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("# 1. Title", "# Title"),
        ("# 1. Title", "# 1. Title."),
        ("2026-11-24", "yesterday"),
        ("accepted", "proposed"),
        ("accepted", "superseded by 0002"),
        ("nothing", "the first"),
        ("\n\nText.\n", "\n"),
    ],
)
def test_a_head_that_is_written_otherwise_is_refused(
    tmp_path: Path, right: str, wrong: str
) -> None:
    file = tmp_path / "0001-title.md"
    file.write_text(HEAD, "utf-8")
    assert read_decision(file).title == "Title"
    file.write_text(HEAD.replace(right, wrong), "utf-8")
    with pytest.raises(ValueError, match="0001-title"):
        read_decision(file)
