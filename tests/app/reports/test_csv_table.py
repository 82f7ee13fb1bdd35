"""CSV is complete, and safe with ids that mean harm."""

import csv
import io
import re

from app.reports.csv_table import FORMULA_STARTS, comparison_to_csv
from solver.comparison.result import Comparison
from tests.app.reports.conftest import HOSTILE


def test_csv_has_a_line_a_row_and_a_column_a_figure(comparison: Comparison) -> None:
    lines = list(csv.DictReader(io.StringIO(comparison_to_csv(comparison))))
    assert len(lines) == len(comparison.rows)
    for line, row in zip(lines, comparison.rows, strict=True):
        assert line["target_id"] == row.target_id
        assert line["solved"] == str(row.solved).lower()
        assert line["index"] == ("" if row.index is None else repr(row.index))
        assert line["joint_1"] == ("" if row.joints is None else repr(row.joints[0]))
        assert float(line["time_s"]) == row.time_s
    assert "residual_excess_m" in lines[0]


def test_csv_is_no_formula(hostile: Comparison) -> None:
    lines = list(csv.DictReader(io.StringIO(comparison_to_csv(hostile))))
    ids = list(dict.fromkeys(line["target_id"] for line in lines))
    assert ids == [HOSTILE[0], f"'{HOSTILE[1]}", HOSTILE[2]]
    negative = re.compile(r"-\d")
    for line in lines:
        for cell in line.values():
            assert not cell.startswith(FORMULA_STARTS) or negative.match(cell)
