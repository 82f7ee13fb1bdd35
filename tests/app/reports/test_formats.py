"""JSON, CSV, Markdown, HTML: complete, and safe with ids that mean harm."""

import base64
import csv
import dataclasses
import hashlib
import html.parser
import io
import json
import re
from typing import Any

import orjson
import pytest
from pydantic import TypeAdapter

from app.reports.csv_table import FORMULA_STARTS, comparison_to_csv
from app.reports.html import comparison_to_html, content_security_policy, waiting_page
from app.reports.json_values import comparison_to_wire
from app.reports.markdown import comparison_to_markdown
from app.reports.picture import Picture
from app.reports.tables import FAILED, ROW_COLUMNS, number, row_table, seconds
from app.schemas.comparison_results import (
    ComparisonResultAnswer,
    ComparisonRowAnswer,
    MethodSummaryAnswer,
)
from solver.comparison.result import Comparison, MethodSummary, Row
from solver.comparison.run import run_contest
from tests.solver.comparison.contests import small_contest

HOSTILE = (
    "<script>alert(1)</script>",
    '=HYPERLINK("http://x")',
    "a|b`c`[d](e)\n# f $x$ \"'&amp;",
)
PICTURE = Picture("times.png", "a <picture> & more", b"\x89PNG")


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    return run_contest(small_contest(), repeats=1)


@pytest.fixture(scope="module")
def hostile() -> Comparison:
    contest = small_contest(ids=HOSTILE)
    return run_contest(
        dataclasses.replace(contest, title="<b>", notes=("</style><img src=x>",)), repeats=1
    )


def has_none(value: Any) -> bool:
    if isinstance(value, dict):
        return any(map(has_none, value.values()))
    return any(map(has_none, value)) if isinstance(value, list) else value is None


def test_json_has_the_fields_of_the_contract_and_no_null(comparison: Comparison) -> None:
    document = json.loads(orjson.dumps(comparison_to_wire(comparison)))
    assert not has_none(document)
    assert {"scenario", "machine", "rows"} <= set(document)
    first, *_ = document["rows"]
    assert first["target_id"] == "1"
    assert first["method"] == "ncos"
    assert first["solved"] is True
    assert first["index"] == 1.0
    assert first["time_s"] > 0
    assert (first["published_index"], first["published_time_s"]) == (1.0, 0.5)
    failed = [row for row in document["rows"] if not row["solved"]]
    assert {row["method"] for row in failed} == {"wrong", "raises", "half"}
    assert not any("index" in row or "gap" in row for row in failed)
    assert not any("published_index" in row for row in document["rows"] if row["target_id"] == "3")


def test_schema_of_the_result_is_what_is_answered(comparison: Comparison) -> None:
    for model, part in (
        (ComparisonResultAnswer, Comparison),
        (ComparisonRowAnswer, Row),
        (MethodSummaryAnswer, MethodSummary),
    ):
        assert list(model.model_fields) == [entry.name for entry in dataclasses.fields(part)]
    body = orjson.dumps(comparison_to_wire(comparison))
    answer = TypeAdapter(ComparisonResultAnswer).validate_json(body, strict=True)
    assert json.loads(answer.model_dump_json()) == json.loads(body)


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


class _Page(html.parser.HTMLParser):
    """Tags with their attributes, and text without the style's."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text.append(data)


def test_html_shows_hostile_text_as_text(hostile: Comparison) -> None:
    page = _Page(comparison_to_html(hostile, [PICTURE]))
    assert not {"script", "b", "iframe", "link"} & {tag for tag, _ in page.tags}
    for shown in (*HOSTILE, "<b>", "</style><img src=x>"):
        assert shown in page.text
    images = [attributes for tag, attributes in page.tags if tag == "img"]
    assert [image["alt"] for image in images] == [PICTURE.caption]


def test_html_needs_nothing_from_elsewhere(comparison: Comparison) -> None:
    text = comparison_to_html(comparison, [PICTURE])
    for _, attributes in _Page(text).tags:
        for name in ("src", "href", "action", "data"):
            value = attributes.get(name) or "data:"
            assert value.startswith("data:")
        assert not any(name.startswith("on") for name in attributes)
        assert "style" not in attributes
    assert "url(" not in text
    assert "@import" not in text


def test_style_of_the_page_is_the_one_that_its_policy_allows(comparison: Comparison) -> None:
    waiting = waiting_page(scenario="x", status="running", waits=True, rows_done=1, rows_total=9)
    for text in (comparison_to_html(comparison, []), waiting):
        (style,) = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in content_security_policy()
        meta = [attributes for tag, attributes in _Page(text).tags if tag == "meta"]
        assert content_security_policy() in {attributes.get("content") for attributes in meta}
    assert "1 of 9 rows" in waiting
    assert 'http-equiv="refresh"' in waiting
    assert "refresh" not in waiting_page(scenario="x", status="failed", waits=False, detail="y")


def test_markdown_shows_hostile_text_as_text(hostile: Comparison) -> None:
    text = comparison_to_markdown(hostile, [PICTURE])
    assert "<script>" not in text
    assert "\\<script\\>" in text
    for line in text.splitlines():
        if line.startswith("| "):
            cells = len(re.findall(r"(?<!\\)\|", line))
            assert cells > 3
    assert "\n# f" not in text
    assert f"]({PICTURE.file})" in text


def test_every_report_names_machine_versions_and_seeds(comparison: Comparison) -> None:
    for text in (
        comparison_to_html(comparison, []),
        comparison_to_markdown(comparison, []).replace("\\", ""),
    ):
        for said in ("a desk", "Python", "numpy", "seeds", "made up", "height [m²]"):
            assert said in text
        assert comparison.machine["processor"].split()[0] in text


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
