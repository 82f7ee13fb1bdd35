"""Decisions, a file each, and their index."""

import re
from dataclasses import dataclass
from pathlib import Path

from scripts.marked import ROOT, with_marked

FOLDER = ROOT / "docs/decisions"
INDEX = FOLDER / "README.md"

_HEAD = re.compile(
    r"# (?P<number>\d+)\. (?P<title>.+[^.])\n\n"
    r"- date: (?P<date>\d{4}-\d\d-\d\d)\n"
    r"- status: (?P<status>.+)\n"
    r"- supersedes: (?P<supersedes>.+)\n\n"
    r"\S"
)
_LINK = r"\[(\d{4})\]\(\1-[a-z0-9-]+\.md\)"
_PART = rf"{_LINK}(?: in part)?"
_STATUS = re.compile(rf"accepted|superseded (?:in part )?by {_LINK}")
_SUPERSEDES = re.compile(rf"nothing|{_PART}")


@dataclass(frozen=True)
class Decision:
    """One decision's head; `status` and `supersedes` as they are written, links and all."""

    file: Path
    number: int
    title: str
    date: str
    status: str
    supersedes: str

    @property
    def superseded_by(self) -> tuple[str, str] | None:
        """Number of the decision that replaces this one, and " in part" or nothing."""
        found = re.fullmatch(r"superseded( in part)? by \[(\d{4})\].*", self.status)
        return (found[2], found[1] or "") if found else None

    @property
    def replaces(self) -> list[tuple[str, str]]:
        """Numbers of the decisions that this one replaces, each with " in part" or nothing."""
        return re.findall(r"\[(\d{4})\]\([^)]*\)( in part)?", self.supersedes)


def read_decision(file: Path) -> Decision:
    """The head of a decision; ValueError where it is not written as the others are."""
    found = _HEAD.match(file.read_text(encoding="utf-8"))
    if found is None:
        raise ValueError(f"{file.name} does not begin as a decision does")
    if not _STATUS.fullmatch(found["status"]):
        raise ValueError(f"{file.name}: status '{found['status']}'")
    if not all(_SUPERSEDES.fullmatch(part) for part in found["supersedes"].split(", ")):
        raise ValueError(f"{file.name}: supersedes '{found['supersedes']}'")
    number, *head = found.groups()
    return Decision(file, int(number), *head)


def read_decisions() -> list[Decision]:
    """Every decision, by number."""
    return [read_decision(file) for file in sorted(FOLDER.glob("[0-9]*.md"))]


def index_of(decisions: list[Decision]) -> str:
    """The table of the index, newest last."""
    rows = [
        f"| [{row.file.name[:4]}]({row.file.name}) | {row.title} | {row.date} | {row.status} "
        f"| {'' if row.supersedes == 'nothing' else row.supersedes} |\n"
        for row in decisions
    ]
    head = "| number | title | date | status | supersedes |\n| --- | --- | --- | --- | --- |\n"
    return head + "".join(rows)


def index_page() -> str:
    """The index as it should be."""
    return with_marked(INDEX.read_text("utf-8"), "decisions", index_of(read_decisions()))
