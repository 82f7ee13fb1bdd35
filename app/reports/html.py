"""A comparison as one HTML file that needs nothing else: no script, no other file, no network."""

import base64
import hashlib
from collections.abc import Sequence
from functools import cache
from importlib import resources
from typing import Any, Final

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from app.reports.picture import Picture
from app.reports.tables import (
    answer_table,
    machine_lines,
    reading_notes,
    residual_table,
    row_table,
    time_table,
)
from solver.comparison.result import Comparison

TEXT_COLUMNS: Final = ("target", "method", "what", "solved", "cold solved", "detail")


def comparison_to_html(comparison: Comparison, pictures: Sequence[Picture]) -> str:
    """The report, with its pictures inside."""
    return _render(
        "report.html.jinja",
        comparison=comparison,
        text_columns=TEXT_COLUMNS,
        answers=answer_table(comparison),
        times=time_table(comparison),
        notes=reading_notes(comparison),
        pictures=[
            {"caption": picture.caption, "base64": base64.b64encode(picture.png).decode()}
            for picture in pictures
        ],
        rows=row_table(comparison),
        residuals=residual_table(comparison),
        machine=machine_lines(comparison),
    )


def waiting_page(
    *,
    scenario: str,
    status: str,
    waits: bool,
    detail: str = "",
    rows_done: int = 0,
    rows_total: int = 0,
) -> str:
    """What there is to see of a comparison that is not complete; loads itself again if it waits."""
    return _render(
        "waiting.html.jinja",
        scenario=scenario,
        status=status,
        waits=waits,
        detail=detail,
        rows_done=rows_done,
        rows_total=rows_total,
    )


@cache
def content_security_policy() -> str:
    """What a page may load: its own style, by its hash, and pictures inside it. No script."""
    digest = base64.b64encode(hashlib.sha256(_style().encode()).digest()).decode()
    return f"default-src 'none'; style-src 'sha256-{digest}'; img-src data:; base-uri 'none'"


@cache
def _style() -> str:
    return (resources.files("app.reports") / "templates" / "report.css").read_text("utf-8")


def _render(template: str, **values: Any) -> str:
    environment = Environment(
        loader=PackageLoader("app.reports"), autoescape=True, undefined=StrictUndefined
    )
    style, policy = Markup(_style()), content_security_policy()
    page: str = environment.get_template(template).render(style=style, policy=policy, **values)
    return page
