"""The rooms, their drawing and the index of decisions are what the code and the files give."""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from itertools import pairwise

import pytest

from scripts.floor_plan import Plan, plan_of
from scripts.house_drawing import drawing_of
from scripts.marked import ROOT
from scripts.rooms import HOUSES, Room, read_houses, table_of, without_detours
from scripts.update_docs import documents


def room(name: str, *neighbours: str) -> Room:
    return Room(name, "What it is for.", False, (), neighbours)


@pytest.fixture(scope="module")
def houses() -> list[Room]:
    return read_houses()


def test_generated_documents_are_those_of_the_code() -> None:
    for file, text in documents().items():
        assert file.read_text("utf-8") == text, f"{file.relative_to(ROOT)}: run make docs"


def test_every_folder_of_the_code_is_a_room_that_says_what_it_is_for(houses: list[Room]) -> None:
    folders = {
        f"{folder.relative_to(ROOT)}/"
        for house in HOUSES
        for folder in [ROOT / house, *(ROOT / house).rglob("*")]
        if folder.is_dir() and any(folder.glob("*.py"))
    }
    rooms = {each.path: each for house in houses for each in house.all_rooms()}
    assert folders == {path for path in rooms if path.endswith("/")}
    for each in rooms.values():
        assert each.summary.endswith("."), each.name


def test_a_room_an_import_and_a_docstring_change_table_and_drawing(houses: list[Room]) -> None:
    solver = houses[-1]
    floors = [list(floor) for floor in solver.floors]
    (planner,) = floors[1]
    drawing, table = drawing_of(houses), table_of(solver)

    def with_second_floor(*rooms: Room) -> Room:
        return replace(solver, floors=(solver.floors[0], rooms, *solver.floors[2:]))

    more = with_second_floor(planner, room("solver.scene"))
    assert table_of(more) != table
    assert drawing_of([*houses[:2], more]) != drawing
    fewer_imports = with_second_floor(replace(planner, neighbours=()))
    assert drawing_of([*houses[:2], fewer_imports]) != drawing
    assert table_of(with_second_floor(replace(planner, summary="Something else."))) != table


def test_imports_that_follow_from_others_have_no_arrow() -> None:
    rooms = [room("a", "b", "c", "ground"), room("b", "c"), room("c")]
    assert without_detours(rooms) == [("a", "b"), ("b", "c")]


def overlaps(plan: Plan) -> bool:
    return any(
        right.x - right.width / 2 < left.x + left.width / 2
        for floor in plan.floors
        for left, right in pairwise(floor)
    )


def test_boxes_and_arrows_past_them_do_not_overlap() -> None:
    floors = [[("a", 90), ("b", 60)], [("c", 300)], [("d", 80), ("e", 80), ("f", 80)]]
    arrows = [("a", "c"), ("b", "c"), ("b", "d"), ("a", "f"), ("c", "e")]
    plan = plan_of(floors, arrows)
    assert not overlaps(plan)
    assert [place.is_lane for place in plan.ways["a", "f"]] == [False, True, False]
    assert min(p.x - p.width / 2 for floor in plan.floors for p in floor) == 0


def test_arrows_do_not_cross_without_need() -> None:
    plan = plan_of([[("a", 50), ("b", 50)], [("c", 50), ("d", 50)]], [("a", "d"), ("b", "c")])
    a, d = plan.ways["a", "d"]
    b, c = plan.ways["b", "c"]
    assert (a.x < b.x) == (d.x < c.x)


def test_the_drawing_shows_every_room_down_to_the_second_level(houses: list[Room]) -> None:
    drawing = ElementTree.fromstring(drawing_of(houses))
    texts = [element.text or "" for element in drawing.iter("{http://www.w3.org/2000/svg}text")]
    shown = {word.strip() for text in texts for word in text.replace("|", ",").split(",")}
    for house in houses:
        for each in house.all_rooms():
            if each.name.count(".") <= 2:
                assert each.last_name in shown, each.name
