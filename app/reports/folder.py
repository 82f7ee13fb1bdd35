"""A report as files in a folder: all of it or nothing."""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import orjson

from app.reports.csv_table import comparison_to_csv
from app.reports.html import comparison_to_html
from app.reports.json_values import comparison_to_wire
from app.reports.markdown import comparison_to_markdown
from app.reports.picture import PICTURE_FILES
from solver.comparison.contest import Contest
from solver.comparison.result import Comparison

REPORT_FILES: Final = ("report.html", "report.md", "report.csv", "report.json")
OWN_FILES: Final = (*REPORT_FILES, *PICTURE_FILES)


def report_files(contest: Contest, comparison: Comparison) -> dict[str, bytes]:
    """The contents of every file of a report, by name; all of OWN_FILES or fewer pictures."""
    from app.reports.pictures import draw_pictures

    pictures = draw_pictures(contest, comparison)
    return {
        "report.html": comparison_to_html(comparison, pictures).encode(),
        "report.md": comparison_to_markdown(comparison, pictures).encode(),
        "report.csv": comparison_to_csv(comparison).encode(),
        "report.json": orjson.dumps(
            comparison_to_wire(comparison),
            option=orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE,
        ),
        **{picture.file: picture.png for picture in pictures},
    }


def check_folder(folder: Path) -> None:
    """Whether a report can be written there, tried before a long run; nothing is left behind.

    Raises:
        OSError: it cannot, with the file's name.
    """
    for name in OWN_FILES:
        if (folder / name).is_dir():
            raise IsADirectoryError(21, "a folder stands where a file of the report goes",
                                    str(folder / name))  # fmt: skip
    if folder.exists():
        with tempfile.TemporaryDirectory(prefix=".prunus-", dir=folder):
            return
    made = [parent for parent in folder.parents if not parent.exists()]
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".prunus-", dir=folder.parent):
            pass
    finally:
        for parent in made:
            with contextlib.suppress(OSError):
                parent.rmdir()


def write_report(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write the files of a report into a folder.

    Everything is written beside its place first. A new folder then appears whole. In one that is
    there already each file of an earlier report is replaced whole, pictures that the new report
    does not have are removed, and files that are not a report's stay as they are.

    Raises:
        OSError: it cannot be written; what was there before is still there.
    """
    is_new = not folder.exists()
    folder.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(prefix=".prunus-", dir=folder.parent if is_new else folder))
    try:
        for name, content in files.items():
            with (beside / name).open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
        if is_new:
            beside.chmod(_folder_mode())
            beside.rename(folder)
            return
        for name in files:
            (beside / name).replace(folder / name)
        for name in set(OWN_FILES) - set(files):
            (folder / name).unlink(missing_ok=True)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _folder_mode() -> int:
    # Temporary folders are for their owner only; a report's is as any other folder.
    mask = os.umask(0)
    os.umask(mask)
    return 0o777 & ~mask
