"""The table of frames."""

import threading
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import pytest
from sqlalchemy import URL, Engine

from app.store import FramesFull, FrameStore, frames, open_engine


@pytest.fixture
def engine(tmp_path: Path) -> Iterator[Engine]:
    opened = open_engine(URL.create("sqlite", database=str(tmp_path / "prunus.sqlite3")))
    yield opened
    opened.dispose()


def times(created_at: datetime, updated_at: datetime) -> str:
    return f"{created_at.isoformat()} {updated_at.isoformat()}"


def test_a_frame_is_stored_replaced_and_removed(engine: Engine) -> None:
    store = FrameStore(engine)
    first = store.put("camera", times)
    assert first.is_new
    created_at, updated_at = first.document.split()
    assert created_at == updated_at
    second = store.put("camera", times)
    assert not second.is_new
    kept, later = second.document.split()
    assert kept == created_at
    assert later > updated_at
    assert store.document("camera") == second.document
    assert store.remove("camera")
    assert not store.remove("camera")
    assert store.document("camera") is None


def test_frames_are_listed_by_name(engine: Engine) -> None:
    store = FrameStore(engine)
    for name in ("b", "a", "B", "_"):
        store.put(name, lambda *_, name=name: name)
    assert list(store.documents()) == ["B", "_", "a", "b"]


def test_a_document_that_cannot_be_made_leaves_what_was_there(engine: Engine) -> None:
    store = FrameStore(engine)
    store.put("camera", lambda *_: "first")

    def broken(*_: datetime) -> str:
        raise ZeroDivisionError

    for name in ("camera", "other"):
        with pytest.raises(ZeroDivisionError):
            store.put(name, broken)
    assert list(store.documents()) == ["first"]


def test_there_is_an_end_to_frames(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frames, "MOST_FRAMES", 2)
    store = FrameStore(engine)
    for name in ("a", "b"):
        store.put(name, times)
    with pytest.raises(FramesFull):
        store.put("c", times)
    assert not store.put("a", times).is_new
    assert len(store.documents()) == 2


def test_one_of_many_at_once_is_new(engine: Engine) -> None:
    store = FrameStore(engine)
    found: list[bool] = []
    together = threading.Barrier(8)

    def put() -> None:
        together.wait()
        found.append(store.put("camera", times).is_new)

    threads = [threading.Thread(target=put) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(found) == [False] * 7 + [True]
