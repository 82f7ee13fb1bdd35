"""Five rounds of what `python -m bench.service.kills` does a hundred times."""

from pathlib import Path

from bench.service.kill_checks import changed_parts
from bench.service.kills import Trial, kill_rounds


def test_nothing_is_lost_or_done_twice_when_the_service_is_killed(tmp_path: Path) -> None:
    report = kill_rounds(Trial(rounds=5, database_url="", folder=tmp_path, seed=1))
    assert report["violations"] == []
    assert report["answered"]["plan"] >= 5
    assert report["answered"]["execution"] >= 1
    assert report["sent_again"] >= 1


def test_a_part_that_was_stored_again_is_seen() -> None:
    before = {("a", 0): "x", ("a", 1): "y"}
    assert changed_parts(before, {**before, ("a", 2): "z"}) == []
    assert len(changed_parts(before, {("a", 0): "x"})) == 1
    assert len(changed_parts(before, {("a", 0): "x", ("a", 1): "other"})) == 1
