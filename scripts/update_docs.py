"""Writes what documents say of the code: rooms, their drawing, and the index of decisions."""

from collections.abc import Sequence
from pathlib import Path

from scripts.decisions import INDEX, index_page
from scripts.house_drawing import drawing_of
from scripts.marked import ROOT, with_marked
from scripts.rooms import Room, read_houses, table_of

ARCHITECTURE = ROOT / "docs/architecture.md"
DRAWING = ROOT / "docs/pictures/architecture.svg"


def architecture_page(houses: Sequence[Room]) -> str:
    """The page with the tables of rooms, as it should be."""
    text = ARCHITECTURE.read_text("utf-8")
    for house in houses:
        text = with_marked(text, f"rooms of {house.name}", table_of(house))
    return text


def documents() -> dict[Path, str]:
    """Every generated file as it should be."""
    houses = read_houses()
    return {
        ARCHITECTURE: architecture_page(houses),
        DRAWING: drawing_of(houses),
        INDEX: index_page(),
    }


def main() -> None:
    for file, text in documents().items():
        file.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
