"""Seeded batches for the service: data set 3's targets, moved a little."""

import json
import random
from pathlib import Path
from typing import Any, Final

import orjson

from solver import Problem, Target, feasible_arcs, load_robot

EXAMPLE: Final = Path(__file__).parents[2] / "openapi" / "examples" / "data_set_3.json"
MOVED_M: Final = 0.03


class Batches:
    """Bodies of POST /v1/plans."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._targets: list[dict[str, Any]] = json.loads(EXAMPLE.read_text())["targets"]

    def body(self, count: int, method: str, **options: Any) -> bytes:
        """A batch of so many targets, with their cut-in rows unless `include` says otherwise.

        About a fifth of them have no approach.
        """
        return self._body([self._target(str(index)) for index in range(count)], method, options)

    def reachable_body(self, count: int, method: str, **options: Any) -> bytes:
        """The same of targets that all have an approach."""
        drawn = [self._target(str(index)) for index in range(2 * count)]
        targets = [Target(one["id"], one["position_m"], one["branch_direction"]) for one in drawn]
        arcs = feasible_arcs(Problem(load_robot("tabletop"), targets))
        kept = [one for one in drawn if arcs[one["id"]]][:count]
        assert len(kept) == count, "half of them are enough"
        return self._body(kept, method, options)

    def _body(self, targets: list[dict[str, Any]], method: str, options: dict[str, Any]) -> bytes:
        asked = {"method": method, "include": ["path"], **options}
        return orjson.dumps({"robot": "tabletop", "targets": targets, "options": asked})

    def _target(self, name: str) -> dict[str, Any]:
        model = self._random.choice(self._targets)
        moved = [value + self._random.uniform(-MOVED_M, MOVED_M) for value in model["position_m"]]
        return {**model, "id": name, "position_m": moved}
