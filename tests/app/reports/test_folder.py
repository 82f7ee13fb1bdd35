"""A report in a folder: all of it or nothing."""

from pathlib import Path

import pytest

from app.reports.folder import OWN_FILES, check_folder, report_files, write_report
from app.reports.html import comparison_to_html
from app.reports.markdown import comparison_to_markdown
from solver.comparison.result import Comparison
from solver.comparison.run import run_contest
from tests.solver.comparison.contests import small_contest

FILES = {"report.html": b"new", "report.json": b"{}", "times.png": b"png"}


def names(folder: Path) -> set[str]:
    return {entry.name for entry in folder.iterdir()}


def test_a_report_has_every_format_and_the_pictures_that_there_are() -> None:
    contest = small_contest()
    files = report_files(contest, run_contest(contest, repeats=1))
    assert set(files) == set(OWN_FILES) - {"poses.png", "effort.png"}
    assert files["times.png"].startswith(b"\x89PNG")
    assert all(files.values())


def test_a_new_folder_has_the_report_and_nothing_else(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "b"
    check_folder(folder)
    assert names(tmp_path) == set()
    write_report(folder, FILES)
    assert names(folder) == set(FILES)
    assert names(folder.parent) == {"b"}
    assert folder.stat().st_mode & 0o055 == (tmp_path / "a").stat().st_mode & 0o055


def test_an_earlier_report_is_replaced_and_other_files_stay(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_bytes(b"old")
    (tmp_path / "effort.png").write_bytes(b"old")
    (tmp_path / "mine.txt").write_bytes(b"mine")
    check_folder(tmp_path)
    write_report(tmp_path, FILES)
    assert names(tmp_path) == {*FILES, "mine.txt"}
    assert (tmp_path / "report.html").read_bytes() == b"new"
    assert (tmp_path / "mine.txt").read_bytes() == b"mine"


@pytest.mark.parametrize("exists", [False, True])
def test_half_a_report_is_never_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exists: bool
) -> None:
    folder = tmp_path / "report"
    if exists:
        folder.mkdir()
        (folder / "report.html").write_bytes(b"old")
    written: list[int] = []

    def full_disk(descriptor: int) -> None:
        written.append(descriptor)
        if len(written) == 2:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(OSError, match="No space"):
        write_report(folder, FILES)
    assert names(tmp_path) == ({"report"} if exists else set())
    if exists:
        assert names(folder) == {"report.html"}
        assert (folder / "report.html").read_bytes() == b"old"


def test_a_folder_that_is_a_file_or_in_a_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_bytes(b"")
    for folder in (file, file / "below"):
        with pytest.raises(OSError, match="file"):
            check_folder(folder)
    (tmp_path / "report.csv").mkdir()
    with pytest.raises(IsADirectoryError):
        check_folder(tmp_path)
    assert names(tmp_path) == {"file", "report.csv"}


def test_every_report_names_machine_versions_and_seeds(comparison: Comparison) -> None:
    for text in (
        comparison_to_html(comparison, []),
        comparison_to_markdown(comparison, []).replace("\\", ""),
    ):
        for said in ("a desk", "Python", "numpy", "seeds", "made up", "height [m²]"):
            assert said in text
        assert comparison.machine["processor"].split()[0] in text
