"""Tables for people."""

import dataclasses

import pytest

from app.reports.tables import FAILED, ROW_COLUMNS, number, row_table, seconds
from solver.comparison.result import Comparison


def test_failures_stay_in_the_table_and_say_so(comparison: Comparison) -> None:
    table = row_table(comparison)
    assert len(table.rows) == len(comparison.rows)
    by_heading = dict(zip(table.headings, zip(*table.rows, strict=True), strict=True))
    for place, row in enumerate(comparison.rows):
        failed = by_heading["index"][place] == FAILED
        assert failed == (not row.solved) == (place in table.failed)
        if failed:
            assert by_heading["solved"][place] == f"no: {row.status}"
            assert by_heading["increase %"][place] == FAILED
            assert by_heading["time less %"][place] == FAILED
            assert by_heading["detail"][place] in ("", row.detail)


def test_columns_that_nobody_fills_are_left_out(comparison: Comparison) -> None:
    bare = dataclasses.replace(
        comparison,
        rows=tuple(
            dataclasses.replace(
                row, published_index=None, published_time_s=None,
                published_difference_percent=None, published_increase_percent=None,
                published_time_reduction_percent=None,
            )
            for row in comparison.rows
        ),
    )  # fmt: skip
    left_out = set(row_table(comparison).headings) - set(row_table(bare).headings)
    assert left_out == {
        column.heading for column in ROW_COLUMNS if column.heading.startswith("published")
    } | {"difference %"}


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.234e-6, "1.23 µs"), (9.996e-4, "1 ms"), (0.0123, "12.3 ms"), (7.7, "7.7 s")],
)
def test_durations_have_the_unit_that_suits(value: float, text: str) -> None:
    assert seconds(value) == text


def test_numbers_for_people() -> None:
    assert number(6385.6412) == "6385.64"
