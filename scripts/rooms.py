"""The rooms of the house as the code has them: what each is for, its floor and what it imports.

A room is a folder, or a file that stands on a floor beside folders. The floors are import-linter's
contracts in pyproject.toml, so a drawing of them cannot differ from what is checked.
"""

import ast
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from grimp import ImportGraph, build_graph

from scripts.marked import ROOT

HOUSES = ("app", "hardware", "solver")
"""From the top floor down."""


@dataclass(frozen=True)
class Room:
    """A folder or file: `solver.approach.arcs`, from its top floor down.

    Attributes:
        name: dotted, as it is imported.
        summary: the first line of its docstring.
        is_file: a file instead of a folder.
        floors: the rooms inside, floor by floor; one floor where no contract tells them apart.
        neighbours: names of the rooms beside it that it imports.
    """

    name: str
    summary: str
    is_file: bool
    floors: tuple[tuple["Room", ...], ...]
    neighbours: tuple[str, ...]

    @property
    def last_name(self) -> str:
        """The name without the rooms that it lies in."""
        return self.name.rpartition(".")[2]

    @property
    def path(self) -> str:
        """The folder or file, from the root of the project."""
        path = self.name.replace(".", "/")
        return f"{path}.py" if self.is_file else f"{path}/"

    def all_rooms(self) -> Iterator["Room"]:
        """This room and all inside it, from the top floor down."""
        yield self
        for floor in self.floors:
            for room in floor:
                yield from room.all_rooms()


def contracts() -> dict[str, list[list[str]]]:
    """Names of rooms by the package that they stand in, floor by floor."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    return {
        container: [sorted(layer.split(" | ")) for layer in contract["layers"]]
        for contract in settings["tool"]["importlinter"]["contracts"]
        for container in contract.get("containers", [])
    }


def _inside(module: str, room: str) -> bool:
    return module == room or module.startswith(f"{room}.")


def _imported(graph: ImportGraph, room: str) -> set[str]:
    """The modules outside a room that any file in it imports."""
    inside = [module for module in graph.modules if _inside(module, room)]
    imported = {
        target for module in inside for target in graph.find_modules_directly_imported_by(module)
    }
    return {module for module in imported if not _inside(module, room)}


def _first(module: str, parts: int) -> str:
    return ".".join(module.split(".")[:parts])


def _file_of(room: str) -> Path:
    path = ROOT / room.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def _summary(file: Path) -> str:
    text = ast.get_docstring(ast.parse(file.read_text("utf-8")))
    if not text:
        raise ValueError(f"{file.relative_to(ROOT)} does not say what it is for")
    return text.splitlines()[0]


def _room(name: str, graph: ImportGraph, floors: dict[str, list[list[str]]]) -> Room:
    file = _file_of(name)
    inside = floors.get(name)
    if inside is None:
        names = sorted(face.parent.name for face in file.parent.glob("*/__init__.py"))
        inside = [names] if names and file.name == "__init__.py" else []
    parent, _, _ = name.rpartition(".")
    imported = _imported(graph, name)
    depth = name.count(".") + 1
    return Room(
        name=name,
        summary=_summary(file),
        is_file=file.name != "__init__.py",
        floors=tuple(
            tuple(_room(f"{name}.{each}", graph, floors) for each in floor) for floor in inside
        ),
        neighbours=tuple(
            sorted(
                _first(module, depth).rpartition(".")[2]
                for module in {_first(module, depth) for module in imported}
                if parent and module.startswith(f"{parent}.")
            )
        ),
    )


def read_houses() -> list[Room]:
    """The houses with every room in them, from the top floor down."""
    graph = build_graph(*HOUSES, cache_dir=None)
    floors = contracts()
    return [_room(house, graph, floors) for house in HOUSES]


def without_detours(rooms: Sequence[Room]) -> list[tuple[str, str]]:
    """Imports between neighbours, without those that follow from others.

    Where a imports b and b imports c, that a imports c too is left out.
    """
    names = {room.last_name for room in rooms}
    imports = {room.last_name: set(room.neighbours) & names for room in rooms}

    def reached(name: str) -> set[str]:
        return imports[name].union(*(reached(each) for each in imports[name]))

    return sorted(
        (name, target)
        for name, targets in imports.items()
        for target in targets
        if not any(target in reached(each) for each in targets)
    )


def table_of(house: Room) -> str:
    """A house's rooms as rows of Markdown, a line each."""
    head = "| room | what belongs there |\n| --- | --- |\n"
    return head + "".join(f"| `{room.path}` | {room.summary} |\n" for room in house.all_rooms())
