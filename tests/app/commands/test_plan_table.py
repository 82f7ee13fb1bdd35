import io
import json
import math
import re
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from app.commands.plan_table import (
    HEADINGS,
    MEASURED_HEADINGS,
    markdown_table,
    plan_rows,
    print_plan,
)
from app.schemas.demo_request import demo_request
from app.services.plans.planning import plan_request

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


def printed(request: dict[str, Any]) -> str:
    console = Console(record=True, width=400, file=io.StringIO())
    print_plan(plan_request(json.dumps(request).encode())[0], console)
    return console.export_text()


def test_a_refused_target_is_told_where_it_would_be_feasible() -> None:
    request = demo_request()
    request["targets"] = request["targets"][:1]
    request["targets"][0]["position_m"] = [0.0, 0.9, 0.1]
    request["options"] = {"method": "ssas", "certify": True}
    words = re.search(
        r"1: out_of_reach, .*; proven infeasible; move it ([\d.]+) mm, by \((.*)\) mm, "
        r"and (.*)° is feasible\n",
        printed(request),
    )
    assert words is not None
    along_mm = [float(value) for value in words[2].split(", ")]
    assert math.hypot(*along_mm) == pytest.approx(float(words[1]), abs=0.1)
    # Moved that far and a rounding further, it is planned.
    further = 1 + 0.3 / float(words[1])
    request["targets"][0]["position_m"] = [
        here + value * further / 1000 for here, value in zip((0.0, 0.9, 0.1), along_mm, strict=True)
    ]
    assert "1 planned, 0 infeasible" in printed(request)


def test_a_refusal_by_angle_names_the_nearest() -> None:
    request = demo_request()
    request["targets"] = request["targets"][:1]
    request["options"] = {"method": "floating_z", "samples": 3}
    assert "1: out_of_reach" in printed(request)
    assert "the nearest feasible angle is -38.46°" in printed(request)


def test_a_slide_is_told_in_millimetres() -> None:
    request = {
        "robot": "puma560_rail",
        "targets": [
            {"id": "1", "position_m": [0.5, 0.1, 0.4], "branch_direction": [0.0, 1.0, 0.2]}
        ],
        "options": {"method": "ssas"},
    }
    text = printed(request)
    assert "1 planned" in text
    assert "start at (0.00, " in text
    assert "; mm, °, °, °, °, °, °)" in text


def test_proven_bounds_are_summed() -> None:
    request = demo_request()
    request["options"] = {"method": "ssas", "order": "independent", "certify": True}
    plan = plan_request(json.dumps(request).encode())[0]
    bound = sum(approach["lower_bound"] for approach in plan["approaches"])
    assert f"at least {bound:.4f} " in printed(request)


def test_table_speaks_degrees_and_keeps_failures(plan: dict[str, Any]) -> None:
    lines = markdown_table(plan).splitlines()
    assert len(lines) == 2 + 5
    assert lines[0].count("|") == len(HEADINGS) + 1
    assert "| 3 | infeasible |" in lines[4]
    angle = np.degrees(plan["approaches"][0]["approach_angle_rad"])
    assert f"| {angle:.2f} |" in lines[2]


def test_ids_that_look_like_markup_are_printed_as_they_are() -> None:
    request = demo_request()
    request["targets"] = request["targets"][:1]
    request["targets"][0]["id"] = "[/x][red]"
    plan, _ = plan_request(json.dumps(request).encode())
    console = Console(record=True, width=200, file=io.StringIO())
    print_plan(plan, console)
    assert console.export_text().count("[/x][red]") == 3
