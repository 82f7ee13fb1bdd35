"""Comparisons to report: of a contest that is known, and of one whose names mean harm."""

import dataclasses

import pytest

from app.reports.picture import Picture
from solver.comparison.result import Comparison
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
