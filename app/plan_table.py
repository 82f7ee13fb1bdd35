"""A plan as a table for people: degrees and millimetres, from the JSON answer."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

HEADINGS: Final = (
    "target",
    "status",
    "angle °",
    "effort",
    "nearest limit °",
    "deviation mm",
    "time ms",
)
TIME_COLUMN: Final = HEADINGS.index("time ms")
MEASURED_HEADINGS: Final = ("standby error mm", "target error mm")


def plan_rows(
    plan: Mapping[str, Any], execution: Mapping[str, Any] | None = None
) -> list[tuple[str, ...]]:
    """One row of text a target, in the order of HEADINGS.

    With an execution of the plan MEASURED_HEADINGS follow: how far the tool centre point was from
    standby and target when the servos had arrived.
    """
    rows = [_row(approach) for approach in plan["approaches"]]
    if execution is None:
        return rows
    measured = {target["target_id"]: _measured(target) for target in execution["targets"]}
    return [(*row, *measured[row[0]]) for row in rows]


def print_plan(
    plan: Mapping[str, Any], console: Console, execution: Mapping[str, Any] | None = None
) -> None:
    """Print the plan, its postures, and a reason for every target refused."""
    options = plan["options"]
    title = f"{plan['robot']} with {plan['tool']}: {options['method']}, order {options['order']}"
    console.print(_table(title, _headings(execution), plan_rows(plan, execution)))
    planned = [approach for approach in plan["approaches"] if approach["status"] == "planned"]
    if planned:
        joints = range(1, len(planned[0]["thinning_joints"]) + 1)
        for name in ("thinning", "standby"):
            rows = [
                (approach["target_id"], *map(_degrees, approach[f"{name}_joints"]))
                for approach in planned
            ]
            headings = ("target", *(f"joint {i} °" for i in joints))
            console.print(_table(f"{name} posture", headings, rows))
    for approach in plan["approaches"]:
        if "reason" in approach:
            reason = approach["reason"]
            console.print(
                f"{approach['target_id']}: {reason['code']}, {reason['detail']}",
                markup=False,
                highlight=False,
            )
    console.print(_totals(plan), highlight=False)


def markdown_table(plan: Mapping[str, Any], execution: Mapping[str, Any] | None = None) -> str:
    """The rows as a Markdown table."""
    headings = _headings(execution)
    lines = [headings, tuple("---" for _ in headings), *plan_rows(plan, execution)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _headings(execution: Mapping[str, Any] | None) -> tuple[str, ...]:
    return HEADINGS if execution is None else (*HEADINGS, *MEASURED_HEADINGS)


def _measured(target: Mapping[str, Any]) -> tuple[str, ...]:
    errors = (target.get("standby_error_m"), target.get("target_error_m"))
    return tuple("" if error is None else f"{error * 1000:.2f}" for error in errors)


def _row(approach: Mapping[str, Any]) -> tuple[str, ...]:
    solver = approach["solver"]
    head = (approach["target_id"], approach["status"])
    time_ms = f"{solver['elapsed_s'] * 1000:.1f}"
    if approach["status"] != "planned":
        return (*head, "", "", "", "", time_ms)
    return (
        *head,
        _degrees(approach["approach_angle_rad"]),
        f"{approach['effort']:.4f}",
        _degrees(approach["margin_rad"]),
        f"{approach['path_deviation_m'] * 1000:.4f}",
        time_ms,
    )


def _totals(plan: Mapping[str, Any]) -> str:
    summary, norm = plan["summary"], plan["options"]["norm"]
    unit = {"l1": "rad", "l2": "rad²"}.get(norm, norm)
    return (
        f"{summary['planned']} planned, {summary['infeasible']} infeasible, "
        f"total effort {summary['total_effort']:.4f} {unit} ({norm}), "
        f"start at ({', '.join(map(_degrees, plan['start_joints']))})°, "
        f"stand-off {plan['options']['standoff_m'] * 100:g} cm, "
        f"{summary['elapsed_s'] * 1000:.0f} ms"
    )


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.2f}"


def _table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """A table of which no number is cut; the plan's rows fit into 80 columns."""
    table = Table(
        title=title,
        title_justify="left",
        box=SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
    for heading in headings:
        words = heading in ("target", "status")
        broken = heading.replace(" ", "\n").replace("\n°", " °")
        table.add_column(broken, justify="left" if words else "right", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))  # as it is: an id may look like markup
    return table
