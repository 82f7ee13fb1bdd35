"""Seeded batches for the service: data set 3's targets, moved a little."""

import json
import random
from pathlib import Path
from typing import Any, Final

import orjson

EXAMPLE: Final = Path(__file__).parents[2] / "openapi" / "examples" / "data_set_3.json"
MOVED_M: Final = 0.03


class Batches:
    """Bodies of POST /v1/plans."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._targets: list[dict[str, Any]] = json.loads(EXAMPLE.read_text())["targets"]

    def body(self, count: int, method: str, *, include: tuple[str, ...] = ("path",)) -> bytes:
        """A batch of so many targets, with their cut-in rows unless `include` says otherwise."""
        targets = [self._target(str(index)) for index in range(count)]
        options = {"method": method, "include": include}
        return orjson.dumps({"robot": "tabletop", "targets": targets, "options": options})

    def _target(self, name: str) -> dict[str, Any]:
        model = self._random.choice(self._targets)
        moved = [value + self._random.uniform(-MOVED_M, MOVED_M) for value in model["position_m"]]
        return {**model, "id": name, "position_m": moved}
