"""The drawing of the house: floors from top to bottom, rooms as boxes, imports as arrows.

SVG written by hand, in whole pixels, so that the same code gives the same bytes everywhere.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

from scripts.floor_plan import Place, Plan, plan_of
from scripts.rooms import Room, without_detours

NAME_SIZE, NOTE_SIZE = 14, 11
NAME_LETTER, NOTE_LETTER = 0.7, 0.6  # widths of letters in their sizes, bold and plain, widest font
PAD = 10
ROOM_HEIGHT = 30
NOTE_HEIGHT = 16
ARROWS_HEIGHT = 30
GROUND_HEIGHT = 26
GROUND_GAP = 14
HOUSE_GAP = 48
BAND = 5

TINTS = {"app": "#e7eff9", "hardware": "#fbf0e0", "solver": "#e8f4e8"}
FRAMES = {"app": "#5b82b5", "hardware": "#b98a3e", "solver": "#5f9a5f"}

STYLE = (
    "text { font-family: 'DejaVu Sans', Verdana, Helvetica, sans-serif; fill: #222 }"
    f" .name {{ font-size: {NAME_SIZE}px; font-weight: bold }}"
    f" .file {{ font-size: {NAME_SIZE}px }}"
    f" .note {{ font-size: {NOTE_SIZE}px; fill: #555 }}"
    " .house { font-size: 20px; font-weight: bold }"
    " .legend { font-size: 13px }"
    " .arrow { fill: none; stroke: #777; stroke-width: 1.3 }"
    " .big { stroke: #444; stroke-width: 4 }"
)

LEGEND = (
    "Each band is a floor: a room imports only",
    "from the floors below its own.",
    "",
    "Bold: a folder, small under it those inside. Thin: a file.",
    "",
    "Arrow: imports. An import that follows",
    "from other arrows has none of its own.",
    "",
    "Grey: the ground. All rooms above it in the",
    "same box may import it, without arrows.",
)


@dataclass(frozen=True)
class Drawn:
    """A part of the drawing with its size; its elements begin at (0, 0)."""

    width: float
    height: float
    elements: tuple[str, ...]

    def at(self, x: float, y: float) -> str:
        """The elements, moved."""
        return f'<g transform="translate({x:.0f} {y:.0f})">{"".join(self.elements)}</g>\n'


def _text(x: float, y: float, text: str, kind: str, anchor: str = "middle") -> str:
    place = f'x="{x:.0f}" y="{y:.0f}" class="{kind}" text-anchor="{anchor}"'
    return f"<text {place}>{escape(text)}</text>"


def _box(width: float, height: float, fill: str, frame: str, opacity: float = 1) -> str:
    size = f'width="{width:.0f}" height="{height:.0f}" rx="5"'
    return f'<rect {size} fill="{fill}" stroke="{frame}" fill-opacity="{opacity:g}"/>'


def _head(name: str, size: int, colour: str) -> str:
    place = f'viewBox="0 0 8 8" refX="2" refY="4" markerWidth="{size}" markerHeight="{size}"'
    tip = f'<path d="M0 0L8 4L0 8z" fill="{colour}"/>'
    return f'<marker id="{name}" {place} orient="auto">{tip}</marker>'


def _width_of(name: str, note: str = "") -> float:
    return max(len(name) * NAME_SIZE * NAME_LETTER, len(note) * NOTE_SIZE * NOTE_LETTER) + 2 * PAD


def _ground_of(room: Room) -> int:
    """How many of the lowest floors have files only: what all above may stand on."""
    count = 0
    for floor in reversed(room.floors):
        if not all(each.is_file for each in floor):
            break
        count += 1
    return count


def _room(room: Room, frame: str) -> Drawn:
    """A room as a box: a name, and the rooms inside, as floors where it has some."""
    if len(room.floors) > 1:
        inside = _floors(room, frame)
        width, top = inside.width + 2 * PAD, ROOM_HEIGHT + BAND
        height = top + inside.height + PAD
        name = _text(PAD, 21, room.last_name, "name", "start")
        return Drawn(
            width,
            height,
            (
                _box(width, height, TINTS[room.name.partition(".")[0]], frame),
                name,
                inside.at(PAD, top),
            ),
        )
    note = ", ".join(each.last_name for floor in room.floors for each in floor)
    width = _width_of(room.last_name, note)
    height = ROOM_HEIGHT + (NOTE_HEIGHT if note else 0)
    elements = [_box(width, height, "#fff", frame)]
    kind = "file" if room.is_file else "name"
    elements.append(_text(width / 2, 20, room.last_name, kind))
    if note:
        elements.append(_text(width / 2, 37, note, "note"))
    return Drawn(width, height, tuple(elements))


def _ends(plan: Plan, downwards: bool) -> dict[tuple[str, str], float]:
    """Where on its box each arrow begins (or ends), so that those of one box lie side by side."""
    ends = {}
    for name in sorted({pair[0 if downwards else 1] for pair in plan.ways}):
        mine = [pair for pair in plan.ways if pair[0 if downwards else 1] == name]
        mine.sort(key=lambda pair: plan.ways[pair][1 if downwards else -2].x)
        box = plan.ways[mine[0]][0 if downwards else -1]
        step = min(20.0, box.width / (len(mine) + 1))
        for k, pair in enumerate(mine):
            ends[pair] = box.x + (k - (len(mine) - 1) / 2) * step
    return ends


def _arrows(plan: Plan, tops: Mapping[Place, float], bottoms: Mapping[Place, float]) -> list[str]:
    """The arrows as curves in the gaps between floors; past a floor they go straight down."""
    starts, ends = _ends(plan, True), _ends(plan, False)
    elements = []
    for pair, way in sorted(plan.ways.items()):
        x, y = starts[pair], bottoms[way[0]]
        path = [f"M{x:.0f} {y:.0f}"]
        for place in way[1:]:
            to_x = place.x if place.is_lane else ends[pair]
            to_y = tops[place] - (0 if place.is_lane else 6)
            y = max(y, to_y - ARROWS_HEIGHT)
            middle = (y + to_y) / 2
            path.append(f"V{y:.0f}")
            path.append(f"C{x:.0f} {middle:.0f} {to_x:.0f} {middle:.0f} {to_x:.0f} {to_y:.0f}")
            x, y = to_x, bottoms[place]
        elements.append(f'<path class="arrow" d="{"".join(path)}" marker-end="url(#head)"/>')
    return elements


def _ground(floor: Sequence[Room], width: float) -> Drawn:
    bar = _box(width, GROUND_HEIGHT, "#dcdcdc", "#aaa")
    return Drawn(width, GROUND_HEIGHT, (bar, _text(width / 2, 18, _side_by_side(floor), "file")))


def _side_by_side(floor: Sequence[Room]) -> str:
    return " | ".join(room.last_name for room in floor)


def _floors(room: Room, frame: str, least_width: float = 0) -> Drawn:
    """The floors of a room, one under the other, over the ground that all of them stand on."""
    count = len(room.floors) - _ground_of(room)
    floors, ground = room.floors[:count], room.floors[count:]
    drawn = {each.last_name: _room(each, frame) for floor in floors for each in floor}
    sizes = [[(each.last_name, drawn[each.last_name].width) for each in floor] for floor in floors]
    plan = plan_of(sizes, without_detours([each for floor in floors for each in floor]))
    widths = [_width_of(_side_by_side(floor)) for floor in ground]
    width = max([least_width, plan.width + 2 * PAD, *widths])
    bands, boxes = [], []
    tops, bottoms = {}, {}
    y = 0.0
    for row in plan.floors:
        height = max(drawn[place.name].height for place in row if not place.is_lane)
        band = _box(width, height + 2 * BAND, "#fff", "none", opacity=0.55)
        bands.append(Drawn(width, height, (band,)).at(0, y - BAND))
        for place in row:
            place.x += (width - plan.width) / 2
            own = height if place.is_lane else drawn[place.name].height
            tops[place] = y + (height - own) / 2
            bottoms[place] = tops[place] + own
            if not place.is_lane:
                boxes.append(drawn[place.name].at(place.x - place.width / 2, tops[place]))
        y += height + ARROWS_HEIGHT
    y += GROUND_GAP - ARROWS_HEIGHT
    for floor in ground:
        boxes.append(_ground(floor, width).at(0, y))
        y += GROUND_HEIGHT + GROUND_GAP / 2
    height = y - (GROUND_GAP / 2 if ground else GROUND_GAP)
    return Drawn(width, height, (*bands, *_arrows(plan, tops, bottoms), *boxes))


def _house(house: Room, least_width: float = 0) -> Drawn:
    frame, top = FRAMES[house.name], 44
    inside = _floors(house, frame, least_width - 2 * PAD)
    width, height = inside.width + 2 * PAD, top + inside.height + PAD
    box = _box(width, height, TINTS[house.name], frame)
    name = _text(PAD, 27, house.name, "house", "start")
    return Drawn(width, height, (box, name, inside.at(PAD, top)))


def _legend() -> Drawn:
    lines = enumerate(LEGEND, start=1)
    return Drawn(0, 0, tuple(_text(0, 18 * k, line, "legend", "start") for k, line in lines))


def drawing_of(houses: Sequence[Room]) -> str:
    """The whole drawing: app over hardware, and beside them solver, which both import."""
    left = max(_house(house).width for house in houses[:2])
    app, hardware = (_house(house, left) for house in houses[:2])
    solver = _house(houses[2])
    solver_x = PAD + left + HOUSE_GAP
    hardware_y = PAD + app.height + HOUSE_GAP
    bottom = hardware_y + hardware.height
    solver_y = bottom - solver.height
    width, height = solver_x + solver.width + PAD, bottom + PAD
    app_y = (max(PAD, solver_y) + PAD + app.height) / 2
    ways = [
        f"M{PAD + left / 2:.0f} {PAD + app.height:.0f}V{hardware_y - 14:.0f}",
        f"M{PAD + left:.0f} {app_y:.0f}H{solver_x - 14:.0f}",
        f"M{PAD + left:.0f} {hardware_y + hardware.height / 2:.0f}H{solver_x - 14:.0f}",
    ]
    size = f'width="{width:.0f}" height="{height:.0f}"'
    view = f'viewBox="0 0 {width:.0f} {height:.0f}"'
    return "".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} {view}>\n',
            f"<style>{STYLE}</style>\n",
            f"<defs>{_head('head', 7, '#777')}{_head('big', 4, '#444')}</defs>\n",
            f'<rect {size} fill="#fff"/>\n',
            app.at(PAD, PAD),
            hardware.at(PAD, hardware_y),
            solver.at(solver_x, solver_y),
            _legend().at(solver_x, 2 * PAD),
            *(f'<path class="big" d="{way}" marker-end="url(#big)"/>\n' for way in ways),
            "</svg>\n",
        ]
    )
