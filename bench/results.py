"""Results as JSON, one file a subject."""

import dataclasses
import json
from pathlib import Path
from typing import Any, Final

from bench.measure import Row
from bench.registry import Subject

FOLDER: Final = Path(__file__).parent / "results"


def as_document(
    subject: Subject, rows: list[Row], machine: dict[str, Any], quick: bool, elapsed_s: float
) -> dict[str, Any]:
    """What is written for a subject; values that are not set are left out."""
    return {
        "subject": subject.name,
        "quick": quick,
        "elapsed_s": round(elapsed_s, 1),
        "machine": machine,
        "rows": [
            {
                key: value
                for key, value in dataclasses.asdict(row).items()
                if value not in (None, "")
            }
            for row in rows
        ],
    }


def write(folder: Path, document: dict[str, Any]) -> None:
    """Writes a subject's results."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / f"{document['subject']}.json").write_text(f"{text}\n", encoding="utf-8")


def write_and_print(
    folder: Path,
    subject: Subject,
    rows: list[Row],
    about: dict[str, Any],
    *,
    quick: bool,
    elapsed_s: float,
) -> int:
    """Write a subject's results and print them; 1 if a figure is missed.

    Args:
        folder: where to.
        subject: that was measured.
        rows: of its report.
        about: the machine as it was at the start.
        quick: whether the sets were small.
        elapsed_s: how long it took.
    """
    write(folder, as_document(subject, rows, about, quick, elapsed_s))
    for line in rows:
        verdict = {True: "reached", False: "NOT REACHED", None: ""}[line.reached]
        print(f"{line.name}: {line.value} {line.unit} {line.wanted} {verdict} {line.note}")
    return int(any(line.reached is False for line in rows))


def read(folder: Path = FOLDER) -> dict[str, dict[str, Any]]:
    """All results of a folder by subject."""
    files = sorted(folder.glob("*.json"))
    return {file.stem: json.loads(file.read_text(encoding="utf-8")) for file in files}


def rows_of(document: dict[str, Any]) -> list[Row]:
    """The lines of a subject's results."""
    return [Row(**{"value": None, "unit": "", **entry}) for entry in document["rows"]]
