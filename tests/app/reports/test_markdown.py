"""Markdown is safe with ids that mean harm."""

import re

from app.reports.markdown import comparison_to_markdown
from solver.comparison.result import Comparison
from tests.app.reports.conftest import PICTURE


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
