"""A plan as a table for people: degrees and millimetres, from the JSON answer."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from hardware.servos.instances import load_instance
from solver import PRISMATIC

HEADINGS: Final = (
    "target",
    "status",
    "angle °",
    "effort",
    "nearest limit °",
    "may move mm",
    "deviation mm",
)
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
    options, units = plan["options"], _joint_units(plan)
    title = f"{plan['robot']} with {plan['tool']}: {options['method']}, order {options['order']}"
    console.print(_table(title, _headings(execution), plan_rows(plan, execution)))
    planned = [approach for approach in plan["approaches"] if approach["status"] == "planned"]
    if planned:
        for name in ("thinning", "standby"):
            rows = [
                (approach["target_id"], *map(_joint, approach[f"{name}_joints"], units))
                for approach in planned
            ]
            headings = ("target", *(f"joint {i} {unit}" for i, unit in enumerate(units, 1)))
            console.print(_table(f"{name} posture", headings, rows))
    for approach in plan["approaches"]:
        if "reason" in approach:
            text = f"{approach['target_id']}: {reason_in_words(approach['reason'])}"
            console.print(text, markup=False, highlight=False)
    console.print(_totals(plan, units), highlight=False)


def reason_in_words(reason: Mapping[str, Any]) -> str:
    """A reason's code, detail, proof and nearest feasible change."""
    words = f"{reason['code']}, {reason['detail']}"
    if "proven" in reason:
        words += "; proven infeasible" if reason["proven"] else "; not proven infeasible"
    if (nearest := reason.get("nearest")) is None:
        return words
    angle = f"{_degrees(nearest['approach_angle_rad'])}°"
    if nearest["kind"] == "displacement":
        along_mm = [value * 1000 for value in nearest["displacement_m"]]
        by = ", ".join(f"{value:.1f}" for value in along_mm)
        words += f"; move it {math.hypot(*along_mm):.1f} mm, by ({by}) mm, and {angle} is feasible"
    else:
        words += f"; the nearest feasible angle is {angle}"
    return words if nearest["verified"] else f"{words} (not verified)"


def markdown_table(plan: Mapping[str, Any], execution: Mapping[str, Any] | None = None) -> str:
    """The rows as a Markdown table."""
    headings = _headings(execution)
    lines = [headings, tuple("---" for _ in headings), *plan_rows(plan, execution)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _headings(execution: Mapping[str, Any] | None) -> tuple[str, ...]:
    return HEADINGS if execution is None else (*HEADINGS, *MEASURED_HEADINGS)


def _measured(target: Mapping[str, Any]) -> tuple[str, ...]:
    errors = (target.get("standby_error_m"), target.get("target_error_m"))
    return tuple(map(_millimetres, errors))


def _row(approach: Mapping[str, Any]) -> tuple[str, ...]:
    head = (approach["target_id"], approach["status"])
    if approach["status"] != "planned":
        return (*head, *[""] * (len(HEADINGS) - len(head)))
    return (
        *head,
        _degrees(approach["approach_angle_rad"]),
        f"{approach['effort']:.4f}",
        _degrees(approach["margin_rad"]),
        _freedom(approach),
        f"{approach['path_deviation_m'] * 1000:.4f}",
    )


def _totals(plan: Mapping[str, Any], units: Sequence[str]) -> str:
    summary, norm = plan["summary"], plan["options"]["norm"]
    bounds = [a["lower_bound"] for a in plan["approaches"] if "lower_bound" in a]
    proven = f", at least {sum(bounds):.4f} from these starts (proven)" if bounds else ""
    start = ", ".join(map(_joint, plan["start_joints"], units))
    start += f"){units[0]}" if len(set(units)) == 1 else f"; {', '.join(units)})"
    unit = {"l1": "rad", "l2": "rad²"}.get(norm, norm)
    return (
        f"{summary['planned']} planned, {summary['infeasible']} infeasible, "
        f"total effort {summary['total_effort']:.4f} {unit} ({norm}){proven}, "
        f"start at ({start}, "
        f"stand-off {plan['options']['standoff_m'] * 100:g} cm, "
        f"{summary['elapsed_s'] * 1000:.0f} ms"
    )


def _joint_units(plan: Mapping[str, Any]) -> list[str]:
    """How each joint is shown: "°", or "mm" for a slide."""
    joints = load_instance(plan["robot"]).robot.joints
    return ["mm" if joint.kind == PRISMATIC else "°" for joint in joints]


def _joint(value: float, unit: str) -> str:
    return _degrees(value) if unit == "°" else f"{value * 1000:.2f}"


def _millimetres(value_m: float | None) -> str:
    return "" if value_m is None else f"{value_m * 1000:.2f}"


def _freedom(approach: Mapping[str, Any]) -> str:
    """How far the target may move, and whether it should be further [mm]."""
    told = _millimetres(approach.get("displacement_margin_m"))
    return f"{told} (short)" if approach.get("margin_short") else told


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
