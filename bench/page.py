"""docs/benchmarks.md and its pictures from bench/results: `python -m bench.page`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from bench.measure import QUANTILES, Row
from bench.pictures import PICTURES, number
from bench.registry import ALL_CORES, SHOWN, Subject
from bench.results import read, rows_of

ROOT: Final = Path(__file__).parents[1]
PAGE: Final = ROOT / "docs" / "benchmarks.md"
PICTURE_FOLDER: Final = ROOT / "docs" / "pictures"

Results = Mapping[str, dict[str, Any]]

_HEAD = """\
# Benchmarks

Written by `make bench-page` from `bench/results/`; do not edit. `make bench` measures anew (see
[CONTRIBUTING.md](../CONTRIBUTING.md)). The value is the median where there are several runs; beside
it the quantiles and the maximum over runs, targets or batches, as the unit says. Runs of what is
compared alternate. What was not reached or failed stays in the tables.
"""


def main() -> None:
    """Writes the page and the pictures."""
    results = read()
    for picture in PICTURES:
        figure = picture.draw(results)
        if figure is not None:
            figure.savefig(PICTURE_FOLDER / picture.file, dpi=110, metadata={"Software": None})
    PAGE.write_text(page(results), encoding="utf-8")


def page(results: Results) -> str:
    """The page's text."""
    parts = [_HEAD, _summary(results)]
    drawn = [picture for picture in PICTURES if picture.draw(results) is not None]
    parts += [f"![{picture.caption}](pictures/{picture.file})\n" for picture in drawn]
    parts += [_section(subject, results.get(subject.name)) for subject in SHOWN]
    return "\n".join(parts)


def _summary(results: Results) -> str:
    wanted = [
        row
        for subject in SHOWN
        if subject.name in results
        for row in rows_of(results[subject.name])
        if row.wanted
    ]
    reached = sum(bool(row.reached) for row in wanted)
    lines = [
        "## What was wanted\n",
        f"{reached} of {len(wanted)} figures are reached.{_reservations(results)}\n",
        "| what | value | wanted | |",
        "| --- | --- | --- | --- |",
    ]
    lines += [f"| {row.name} | {_value(row)} | {row.wanted} | {_verdict(row)} |" for row in wanted]
    return "\n".join([*lines, ""])


def _reservations(results: Results) -> str:
    missing = [f"`{subject.name}`" for subject in SHOWN if subject.name not in results]
    quick = [f"`{name}`" for name, document in results.items() if document["quick"]]
    text = f" Not measured yet: {', '.join(missing)}." if missing else ""
    return text + (f" From quick runs only: {', '.join(quick)}." if quick else "")


def _section(subject: Subject, document: dict[str, Any] | None) -> str:
    head = f"## {subject.title}\n"
    if document is None:
        return f"{head}\nNot measured yet: `{subject.command}`.\n"
    headings = ["what", "value", "wanted", "reached", *QUANTILES, "runs", "note"]
    lines = [
        head,
        _circumstances(subject, document),
        f"| {' | '.join(headings)} |",
        f"| {' | '.join(['---'] * len(headings))} |",
    ]
    lines += [f"| {' | '.join(_cells(row))} |" for row in rows_of(document)]
    return "\n".join([*lines, ""])


def _circumstances(subject: Subject, document: dict[str, Any]) -> str:
    about = document["machine"]
    cores = "every core" if subject.cores == ALL_CORES else "one core"
    versions = ", ".join(f"{name} {version}" for name, version in about["versions"].items())
    text = (
        f"`{subject.command}`, {about['date']}, {cores} of {about['processor']} "
        f"({about['cores']} cores, {about['memory_gib']} GiB, {about['system']}, load at the start "
        f"{about.get('load_average', 'not noted')}); Python {about['python']}, {versions}."
    )
    if document["quick"]:
        text += " **Quick run: small sets and few runs, for a first look only.**"
    return f"{text}\n"


def _cells(row: Row) -> list[str]:
    spread = [number(row.spread[name]) if row.spread else "" for name in QUANTILES]
    return [row.name, _value(row), row.wanted, _verdict(row), *spread, str(row.runs), row.note]


def _value(row: Row) -> str:
    return "failed" if row.value is None else f"{number(row.value)} {row.unit}".strip()


def _verdict(row: Row) -> str:
    return {True: "yes", False: "**no**", None: ""}[row.reached]


if __name__ == "__main__":
    main()
