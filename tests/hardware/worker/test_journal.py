from pathlib import Path

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
