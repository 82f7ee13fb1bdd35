"""Tests lie where their sources lie, and are named after them."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
HOUSES = ("app", "hardware", "solver")
WHOLES = {"app/live/": "whole services", "solver/test_public_names.py": "the solver's face"}


def test_every_test_is_named_after_a_file_or_room_where_it_lies() -> None:
    """`test_servo.py` and `test_servo_motion.py` are both of `servo.py`."""
    lost = []
    for house in HOUSES:
        for test in sorted((ROOT / "tests" / house).rglob("test_*.py")):
            place = test.relative_to(ROOT / "tests").as_posix()
            if place.startswith(tuple(WHOLES)):
                continue
            names = {entry.stem for entry in (ROOT / place).parent.glob("*") if _holds(entry)}
            words = test.stem.removeprefix("test_").split("_")
            if names.isdisjoint("_".join(words[:count]) for count in range(1, len(words) + 1)):
                lost.append(place)
    assert lost == []


def _holds(entry: Path) -> bool:
    return entry.suffix == ".py" or (entry / "__init__.py").exists()
