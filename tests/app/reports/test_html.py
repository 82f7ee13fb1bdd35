"""The page is complete by itself, and safe with ids that mean harm."""

import base64
import hashlib
import html.parser
import re

from app.reports.html import comparison_to_html, content_security_policy, waiting_page
from solver.comparison.result import Comparison
from tests.app.reports.conftest import HOSTILE, PICTURE


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
