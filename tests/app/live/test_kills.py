"""Four rounds of what `python -m bench.service.kills` does a hundred times."""

from pathlib import Path

import pytest
from sqlalchemy import URL

from app.store import NewKey, PlanStore, new_entry, open_engine
from bench.service.kill_checks import changed_parts, check_rows
from bench.service.kill_load import Answered
from bench.service.kills import Trial, kill_rounds


@pytest.mark.long
@pytest.mark.parametrize("database", ["sqlite", "postgresql"])
def test_nothing_is_lost_or_done_twice_when_the_service_is_killed(
    database: str,
    tmp_path: Path,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PRUNUS_WORKERS", "1")  # of each life's start, half is saved
    url = request.getfixturevalue("postgresql_url") if database == "postgresql" else ""
    report = kill_rounds(Trial(rounds=4, database_url=url, folder=tmp_path, seed=1))
    assert report["database"] == database
    assert report["violations"] == []
    assert set(report["killed_while"].values()) == {1}
    assert report["answered"]["plan"] >= 4
    assert report["answered"]["execution"] >= 1
    assert report["sent_again"] >= 1


def test_a_part_that_was_stored_again_is_seen() -> None:
    before = {("a", 0): "x", ("a", 1): "y"}
    assert changed_parts(before, {**before, ("a", 2): "z"}) == []
    assert len(changed_parts(before, {("a", 0): "x"})) == 1
    assert len(changed_parts(before, {("a", 0): "x", ("a", 1): "other"})) == 1


def test_a_plan_lost_or_made_twice_is_seen(tmp_path: Path) -> None:
    engine = open_engine(URL.create("sqlite", database=str(tmp_path / "it.sqlite3")))
    store, plan_id = PlanStore(engine), f"{1:032x}"
    location = f"/v1/plans/{plan_id}"
    kept = Answered("plan", "/v1/plans", "k", b"", 1, 201, location, b"", 1, False)
    assert len(check_rows(engine, [kept])) == 2
    entry = new_entry(NewKey("POST /v1/plans", "k", "0"), 201, location)
    store.add(plan_id, robot="r", request="{}", answer="{}", key=entry)
    assert check_rows(engine, [kept]) == []
    store.add(f"{2:032x}", robot="r", request="{}", answer="{}")
    assert len(check_rows(engine, [kept])) == 1
    engine.dispose()
