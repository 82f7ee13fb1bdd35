"""A comparison as Markdown."""

import re
from collections.abc import Iterable, Sequence

from app.reports.picture import Picture
from app.reports.tables import (
    TextTable,
    answer_table,
    machine_lines,
    reading_notes,
    residual_table,
    row_table,
    time_table,
)
from solver.comparison.result import Comparison

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>#|~!&])")


def comparison_to_markdown(comparison: Comparison, pictures: Sequence[Picture]) -> str:
    """The report, with pictures by their file names in the same folder."""
    found = [f"- {markdown_text(finding)}" for finding in comparison.findings]
    findings = ["## Findings", "\n".join(found)] if found else []
    parts = [
        f"# {markdown_text(comparison.title)}",
        f"Scenario `{_code(comparison.scenario)}`: {markdown_text(comparison.origin)}",
        f"Minimised: {markdown_text(comparison.index_name)}.",
        *map(markdown_text, comparison.notes),
        *findings,
        "## Methods",
        _table(answer_table(comparison)),
        "## Times",
        _table(time_table(comparison)),
        "\n".join(f"- {markdown_text(note)}" for note in reading_notes(comparison)),
        *(
            f"![{markdown_text(picture.caption)}]({picture.file})\n\n{markdown_text(picture.caption)}"
            for picture in pictures
        ),
        "## Targets",
        _table(row_table(comparison)),
    ]
    residuals = residual_table(comparison)
    if residuals.rows:
        parts += ["## Residuals", _table(residuals)]
    parts += [
        "## Measured on",
        "\n".join(f"- {name}: {markdown_text(text)}" for name, text in machine_lines(comparison)),
    ]
    return "\n\n".join(parts) + "\n"


def markdown_text(text: str) -> str:
    """Text that is shown as it is, on one line."""
    return _SPECIAL.sub(r"\\\1", " ".join(text.split()))


def _code(text: str) -> str:
    return " ".join(text.replace("`", "'").split())


def _table(table: TextTable) -> str:
    return "\n".join(
        [
            _line(map(markdown_text, table.headings)),
            _line(["---"] * len(table.headings)),
            *(_line(map(markdown_text, row)) for row in table.rows),
        ]
    )


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
