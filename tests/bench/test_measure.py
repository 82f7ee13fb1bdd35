import dataclasses
import json
import math

import numpy as np
import pytest

from bench.measure import alternating, failed, ratios, row


def test_the_median_counts_and_is_judged() -> None:
    line = row("x", [3.0, 1.0, 2.0], "s", at_most=2.0)
    assert (line.value, line.runs, line.wanted, line.reached) == (2.0, 3, "<= 2", True)
    assert line.spread is not None
    assert line.spread["max"] == 3.0
    assert min(line.spread.values()) == line.spread["median"]


@pytest.mark.parametrize("value", [math.nan, math.inf, [], [1.0, math.inf, 1.0]])
def test_what_has_no_figure_is_not_reached(value: float | list[float]) -> None:
    line = row("x", value, "s", at_most=2.0)
    assert line.value is None
    assert line.reached is False


def test_at_least() -> None:
    assert row("x", 20.0, "", at_least=20.0).reached
    assert row("x", 19.9, "", at_least=20.0).reached is False
    assert row("x", 1.0, "").reached is None
    assert failed("x", "s", "why", "<= 1").reached is False


def test_actions_alternate_after_one_that_is_not_counted() -> None:
    calls: list[str] = []
    actions = {"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}
    times = alternating(actions, 2)
    assert calls == ["a", "b"] * 3
    assert [len(values) for values in times.values()] == [2, 2]
    assert ratios([4.0, 6.0], [2.0, 2.0]) == [2.0, 3.0]


def test_numbers_of_numpy_can_be_written_as_json() -> None:
    written = json.dumps(dataclasses.asdict(row("x", np.float64(2.0), "s", at_most=3.0)))
    assert json.loads(written)["value"] == 2.0
