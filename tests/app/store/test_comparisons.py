"""The table of comparisons."""

import pytest
from sqlalchemy import URL, Engine

from app.store import ComparisonStore, open_engine

ID, OTHER = "0" * 32, "1" * 32


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


def test_comparisons_outlive_the_service(store_url: URL) -> None:
    first = open_engine(store_url)
    ComparisonStore(first).add(ID, scenario="strawberry", document="{}")
    first.dispose()
    again = open_engine(store_url)
    assert ComparisonStore(again).active() == ["{}"]
    again.dispose()
