"""Comparisons of the service: taken on, run one after the other in a solver process, and kept."""

import asyncio
import logging
import tempfile
import uuid
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import orjson
from anyio import to_thread
from sqlalchemy.exc import SQLAlchemyError

from app.reports.html import waiting_page
from app.services.comparisons.running import (
    ComparisonOrder,
    compare_to_bytes,
    prepare,
    read_progress,
)
from app.services.exceptions import NotFound, Unavailable, invalid_request
from app.services.solving.process import SolverLost
from app.services.solving.service import SolvingService
from app.services.store_calls import store_call
from app.store import ACCEPTED, ComparisonStore, NewKey, new_entry
from app.store.failures import cause_of
from hardware.clock import timestamp
from solver import Fault, UnknownEntrant
from solver.comparison.registry import SCENARIOS
from solver.comparison.run import MAXIMUM_REPEATS

logger = logging.getLogger(__name__)

QUEUED, RUNNING, COMPLETED, FAILED = "queued", "running", "completed", "failed"
# Each takes about a minute; more than these would wait longer than anybody does.
MOST_ACTIVE: Final = 20
STORE_RETRY_S: Final = 1.0

Document = dict[str, Any]


@dataclass(frozen=True)
class _Work:
    """A comparison that is waiting or running."""

    document: Document
    order: ComparisonOrder


def location_of(document: Document) -> str:
    """A comparison's path."""
    return f"/v1/comparisons/{document['id']}"


class ComparisonService:
    """The comparisons of the service. It lives on the event loop and is used there only.

    They run one after the other: two at once would spoil each other's times, and leave no process
    for plans.
    """

    def __init__(self, store: ComparisonStore, solving: SolvingService) -> None:
        self._store = store
        self._solving = solving
        self._one_at_a_time = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self._folder = tempfile.TemporaryDirectory(prefix="prunus-comparisons-")

    async def end_interrupted(self) -> None:
        """End what an earlier run of the service left active."""
        for text in await store_call(self._store.active):
            detail = "the service was started again while it was waiting or running"
            await self._end(orjson.loads(text), {"status": FAILED, "detail": detail})

    async def create(
        self,
        scenario: str,
        methods: tuple[str, ...] | None,
        repeats: int | None,
        key: NewKey | None = None,
    ) -> Document:
        """Take on a comparison; it is stored as queued when this returns.

        Raises:
            KeyTaken: something was created under the key before.
            InvalidRequest: there is no such scenario or method.
            Unavailable: too many are waiting.
        """
        if faults := await to_thread.run_sync(_faults, scenario, methods, repeats):
            raise invalid_request(faults)
        if await store_call(self._store.count_active) >= MOST_ACTIVE:
            raise Unavailable("comparisons_full", f"{MOST_ACTIVE} comparisons are waiting already.")
        comparison_id = uuid.uuid4().hex
        document: Document = {"id": comparison_id, "scenario": scenario}
        if methods is not None:
            document["methods"] = list(methods)
        if repeats is not None:
            document["repeats"] = repeats
        document |= {"status": QUEUED, "created_at": timestamp()}
        text = _json(document)
        await store_call(
            self._store.add,
            comparison_id,
            scenario=scenario,
            document=text,
            key=new_entry(key, ACCEPTED, location_of(document), text),
        )
        order = ComparisonOrder(scenario, methods, repeats, self._progress_file(comparison_id))
        task = asyncio.create_task(self._run(_Work(document, order)))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return document

    async def _run(self, work: _Work) -> None:
        async with self._one_at_a_time:
            document = work.document | {"status": RUNNING, "started_at": timestamp()}
            await self._surely(lambda: self._save(document))
            try:
                result, page = await self._solving.run(compare_to_bytes, work.order)
            except SolverLost:
                ending = {"status": FAILED, "detail": "the solver was lost over it"}
                await self._surely(lambda: self._end(document, ending))
            except Exception:
                logger.exception("comparison %s could not be run", document["id"])
                detail = "it could not be run; the service's log says more"
                failed = {"status": FAILED, "detail": detail}
                await self._surely(lambda: self._end(document, failed))
            else:
                complete = {"status": COMPLETED, "result": orjson.loads(result)}
                await self._surely(lambda: self._end(document, complete, page))

    async def _surely(self, store: Callable[[], Awaitable[None]]) -> None:
        """Try again until the database is back: nobody else would end the comparison."""
        while True:
            try:
                return await store()
            except SQLAlchemyError as error:
                logger.warning("a comparison cannot be stored yet: %s", cause_of(error))
                await asyncio.sleep(STORE_RETRY_S)

    async def document(self, comparison_id: str) -> Document:
        """The answer for a comparison, with its progress while it is running.

        Raises:
            NotFound: there is none of this id.
        """
        text = await store_call(self._store.document, comparison_id)
        if text is None:
            raise NotFound("not_found", "There is no comparison of this id.")
        document: Document = orjson.loads(text)
        if document["status"] == RUNNING:
            told = await to_thread.run_sync(read_progress, self._progress_file(comparison_id))
            if told is not None:
                document["progress"] = {"rows_done": told[0], "rows_total": told[1]}
        return document

    async def page(self, comparison_id: str) -> str:
        """The comparison as an HTML page, whatever its state.

        Raises:
            NotFound: there is none of this id.
        """
        page = await store_call(self._store.page, comparison_id)
        if page is not None:
            return page
        document = await self.document(comparison_id)
        return waiting_page(
            scenario=document["scenario"],
            status=document["status"],
            waits=document["status"] in (QUEUED, RUNNING),
            detail=document.get("detail", ""),
            **document.get("progress", {}),
        )

    async def _end(self, document: Document, changes: Document, page: str | None = None) -> None:
        await self._save(document | {"ended_at": timestamp()} | changes, ended=True, page=page)
        self._progress_file(document["id"]).unlink(missing_ok=True)

    async def _save(
        self, document: Document, *, ended: bool = False, page: str | None = None
    ) -> None:
        await store_call(
            self._store.save, document["id"], document=_json(document), ended=ended, page=page
        )

    def _progress_file(self, comparison_id: str) -> Path:
        return Path(self._folder.name) / comparison_id

    async def close(self) -> None:
        """Drop what is waiting or running; the next start ends it."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._folder.cleanup()


def _json(document: Document) -> str:
    return orjson.dumps(document).decode()


def _faults(scenario: str, methods: tuple[str, ...] | None, repeats: int | None) -> list[Fault]:
    faults = []
    if repeats is not None and not 1 <= repeats <= MAXIMUM_REPEATS:
        faults.append(Fault(("repeats",), f"must be between 1 and {MAXIMUM_REPEATS}"))
    if methods is not None and not methods:
        faults.append(Fault(("methods",), "the list is empty"))
    if scenario not in SCENARIOS:
        known = f"unknown scenario; known: {', '.join(SCENARIOS)}"
        return [*faults, Fault(("scenario",), known)]
    try:
        prepare(scenario, methods)
    except UnknownEntrant as error:
        place = (methods or ()).index(error.name)
        detail = f"unknown method; known: {', '.join(error.known)}"
        faults.append(Fault(("methods", place), detail))
    return faults
