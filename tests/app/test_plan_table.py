import json

import pytest
from rich.console import Console

from app.demo_request import demo_request
from app.plan_table import (
    HEADINGS,
    MEASURED_HEADINGS,
    TIME_COLUMN,
    markdown_table,
    plan_rows,
    print_plan,
)
from app.services.planning import plan_request

EXECUTION = {
    "targets": [
        {"target_id": "1", "status": "done", "standby_error_m": 0.00123, "target_error_m": 0.00045},
        *({"target_id": str(number), "status": "skipped"} for number in range(2, 6)),
    ]
}


@pytest.fixture(scope="module")
def plan() -> dict[str, object]:
    request = demo_request()
    request["targets"][2]["position_m"] = [0.0, 2.0, 0.1]
    request["options"]["method"] = "ssas"
    return plan_request(json.dumps(request).encode())[0]


def test_rows_have_the_measured_errors_of_an_execution(plan: dict[str, object]) -> None:
    rows = plan_rows(plan, EXECUTION)
    assert all(len(row) == len(HEADINGS) + len(MEASURED_HEADINGS) for row in rows)
    assert rows[0][-2:] == ("1.23", "0.45")
    assert rows[1][-2:] == ("", "")
    assert [row[: len(HEADINGS)] for row in rows] == plan_rows(plan)


def test_eighty_columns_show_every_number_whole(
    plan: dict[str, object], capsys: pytest.CaptureFixture[str]
) -> None:
    print_plan(plan, Console(width=80), EXECUTION)
    printed = capsys.readouterr().out
    assert "…" not in printed
    assert max(map(len, printed.splitlines())) <= 80
    for row in plan_rows(plan, EXECUTION):
        line = next(line for line in printed.splitlines() if line.startswith(f"{row[0]} "))
        assert line.split() == [cell for cell in row if cell]


def test_the_markdown_table_has_a_column_for_each_heading(plan: dict[str, object]) -> None:
    for execution, columns in ((None, len(HEADINGS)), (EXECUTION, len(HEADINGS) + 2)):
        lines = markdown_table(plan, execution).splitlines()
        assert len(lines) == 2 + 5
        assert {line.count("|") for line in lines} == {columns + 1}


def test_the_time_column_is_the_time(plan: dict[str, object]) -> None:
    assert HEADINGS[TIME_COLUMN] == "time ms"
    assert all(float(row[TIME_COLUMN]) > 0 for row in plan_rows(plan))
