import os
from pathlib import Path

import orjson
import pytest

from hardware.exceptions import JournalFailed, OrderRefused
from hardware.worker.journal import Journal


def test_an_id_is_begun_once_by_this_worker_and_by_later_ones(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "journal"
    first = Journal(path)
    first.start("a")
    first.end("a", "completed")
    for journal in (first, Journal(path)):
        with pytest.raises(OrderRefused, match="begun before"):
            journal.start("a")
        assert journal.unfinished == set()


def test_what_was_never_ended_is_unfinished_for_the_next_worker(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    first = Journal(path)
    first.start("a")
    first.end("a", "failed")
    first.start("b")
    second = Journal(path)
    assert second.unfinished == {"b"}
    second.end("b", "interrupted")
    assert second.unfinished == set()
    assert Journal(path).unfinished == set()


def test_a_half_written_line_costs_only_itself(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    Journal(path).start("a")
    with path.open("ab") as file:
        file.write(b'{"execution_id": "b", "ev')
    assert Journal(path).unfinished == {"a"}
    after = Journal(path)
    after.start("c")
    assert Journal(path).unfinished == {"a", "c"}


def test_a_journal_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal")
    (tmp_path / "journal").unlink()
    (tmp_path / "journal").mkdir()
    with pytest.raises(JournalFailed, match="journal"):
        journal.start("a")


def test_a_folder_that_cannot_be_used_is_an_os_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        Journal(tmp_path / "file" / "journal")


def test_reading_a_journal_that_is_whole_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    Journal(path)
    assert path.read_bytes() == b""
    journal = Journal(path)
    journal.start("a")
    journal.end("a", "completed")
    before = path.read_bytes()
    Journal(path)
    assert path.read_bytes() == before
    assert before.endswith(b"\n")


def test_half_a_line_is_ended_once(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    path.write_bytes(b'{"execution_id": "b", "ev')
    Journal(path)
    Journal(path)
    assert path.read_bytes() == b'{"execution_id": "b", "ev\n'


def test_an_entry_says_what_happened_to_which_and_when(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    journal = Journal(path)
    journal.start("a")
    journal.end("a", "canceled")
    entries = [orjson.loads(line) for line in path.read_bytes().splitlines()]
    assert [(entry["execution_id"], entry["event"]) for entry in entries] == [
        ("a", "started"),
        ("a", "canceled"),
    ]
    assert all(set(entry) == {"at", "execution_id", "event"} for entry in entries)
    assert all(entry["at"].endswith("Z") for entry in entries)


def test_an_entry_is_on_the_disk_when_its_execution_may_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is still in a buffer as the disk is asked to keep the file is not kept."""
    path = tmp_path / "journal"
    journal = Journal(path)
    kept: list[bytes] = []
    monkeypatch.setattr(os, "fsync", lambda descriptor: kept.append(path.read_bytes()))
    journal.start("a")
    journal.end("a", "failed")
    assert [content.count(b"\n") for content in kept] == [1, 2]


def test_an_execution_that_cannot_be_noted_was_not_begun(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    journal = Journal(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(JournalFailed, match=f"{path}: "):
        journal.start("a")
    path.rmdir()
    journal.start("a")
    assert Journal(path).unfinished == {"a"}


def test_lines_that_say_nothing_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    lines = ['{"execution_id": "a", "event": "started"}', "[]", "5", "{}", '{"event": "failed"}']
    path.write_text("\n".join([*lines, "", '{"execution_id": "b", "event": "started"}', ""]))
    journal = Journal(path)
    assert journal.unfinished == {"a", "b"}
    with pytest.raises(OrderRefused, match="execution b was begun before"):
        journal.start("b")


def test_ending_what_is_not_known_here_ends_nothing_else(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal")
    journal.start("a")
    journal.end("b", "failed")
    assert journal.unfinished == set()
    assert Journal(tmp_path / "journal").unfinished == {"a"}
