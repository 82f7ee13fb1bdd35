"""A comparison's rows as CSV, safe to open in a spreadsheet."""

import csv
import io
from dataclasses import fields
from typing import Any, Final

from solver.comparison.result import Comparison, Row

# A spreadsheet takes text that begins so for a formula, and runs it.
FORMULA_STARTS: Final = ("=", "+", "-", "@", "\t", "\r", "\n")


def comparison_to_csv(comparison: Comparison) -> str:
    """One line a row; residuals and joints have a column each, what does not exist is empty.

    Text that a spreadsheet would take for a formula has an apostrophe before it.
    """
    residuals = dict.fromkeys(name for row in comparison.rows for name in row.residuals)
    joints = max((len(row.joints or ()) for row in comparison.rows), default=0)
    plain = [entry.name for entry in fields(Row) if entry.name not in ("residuals", "joints")]
    heading = [
        *plain,
        *(f"residual_{name}" for name in residuals),
        *(f"joint_{k + 1}" for k in range(joints)),
    ]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(_cell, heading))
    for row in comparison.rows:
        values: list[Any] = [getattr(row, name) for name in plain]
        values += [row.residuals.get(name) for name in residuals]
        posture = row.joints or ()
        values += [*posture, *[None] * (joints - len(posture))]
        writer.writerow(map(_cell, values))
    return text.getvalue()


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f"'{value}" if value.startswith(FORMULA_STARTS) else value
    return repr(float(value)) if isinstance(value, float) else str(value)
