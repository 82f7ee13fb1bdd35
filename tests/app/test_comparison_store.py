"""The table of comparisons."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import URL, Engine

from app.store import ComparisonStore, open_engine

ID, OTHER = "0" * 32, "1" * 32


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    opened = open_engine(URL.create("sqlite", database=str(tmp_path / "prunus.sqlite3")))
    yield opened
    opened.dispose()


def test_a_comparison_is_active_until_it_has_ended(engine: Engine) -> None:
    store = ComparisonStore(engine)
    for comparison_id in (ID, OTHER):
        store.add(comparison_id, scenario="strawberry", document=f'"{comparison_id}"')
    assert store.count_active() == 2
    assert store.document(ID) == f'"{ID}"'
    assert store.page(ID) is None
    store.save(ID, document='"running"', ended=False)
    assert store.count_active() == 2
    store.save(ID, document='"completed"', ended=True, page="<html>")
    assert store.active() == [f'"{OTHER}"']
    assert store.count_active() == 1
    assert (store.document(ID), store.page(ID)) == ('"completed"', "<html>")


@pytest.mark.parametrize("comparison_id", ["2" * 32, "", "' OR 1=1", "0" * 33])
def test_unknown_ids_have_nothing(engine: Engine, comparison_id: str) -> None:
    store = ComparisonStore(engine)
    store.add(ID, scenario="strawberry", document="{}")
    assert store.document(comparison_id) is None
    assert store.page(comparison_id) is None


def test_comparisons_outlive_the_service(tmp_path: Path) -> None:
    url = URL.create("sqlite", database=str(tmp_path / "prunus.sqlite3"))
    first = open_engine(url)
    ComparisonStore(first).add(ID, scenario="strawberry", document="{}")
    first.dispose()
    again = open_engine(url)
    assert ComparisonStore(again).active() == ["{}"]
    again.dispose()
