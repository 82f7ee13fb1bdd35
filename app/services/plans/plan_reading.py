"""Stored plans as they are answered: whole, or approach by approach, without holding them twice."""

import json
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import orjson

from app.services.plans.parts import joined
from app.store import PlanStore, StoredPlan
from solver import PLANNED


def plan_chunks(store: PlanStore, plan_id: str, plan: StoredPlan) -> Iterator[bytes]:
    """The body of the answer for a plan, in pieces; this blocks."""
    if not plan.in_parts:
        yield plan.answer.encode()
        return
    yield from joined(plan.answer.encode(), _arrays(store, plan_id, plan))


def whole_answer(store: PlanStore, plan_id: str, plan: StoredPlan) -> bytes:
    """The body of the answer for a plan; this blocks."""
    return b"".join(plan_chunks(store, plan_id, plan))


def plan_lines(store: PlanStore, plan_id: str, plan: StoredPlan) -> Iterator[bytes]:
    """The approaches of a plan in the order of its answer, one a line; this blocks."""
    if plan.in_parts:
        for chunk in _arrays(store, plan_id, plan):
            yield lines_of(orjson.loads(chunk))
        return
    for approach in orjson.loads(plan.answer)["approaches"]:
        yield lines_of((approach,))


def lines_of(approaches: Iterable[Any]) -> bytes:
    """Approaches as JSON, one a line."""
    return b"".join(orjson.dumps(entry, option=orjson.OPT_APPEND_NEWLINE) for entry in approaches)


def _arrays(store: PlanStore, plan_id: str, plan: StoredPlan) -> Iterator[bytes]:
    """JSON arrays that make up the approaches."""
    if json.loads(plan.answer)["options"]["order"] != "optimal":
        for part in store.parts(plan_id):
            yield part.encode()
        return
    # Parts are kept as they were solved. Where the order was chosen, those that are refused come
    # last in the answer, and one that was chosen can still have failed to verify.
    yield from _chosen(store, plan_id, lambda status: status == PLANNED)
    yield from _chosen(store, plan_id, lambda status: status != PLANNED)


def _chosen(store: PlanStore, plan_id: str, wanted: Callable[[str], bool]) -> Iterator[bytes]:
    for part in store.parts(plan_id):
        yield orjson.dumps([entry for entry in orjson.loads(part) if wanted(entry["status"])])
