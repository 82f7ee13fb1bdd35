"""The strawberry mechanism at one target, the pose of each method side by side (S figures 4 to 6).

Run as `python -m app.reports.drawings.strawberry PICTURE.png [NUMBER OF THE TARGET IN TABLE 3]`.
"""

import math
import sys
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from solver import Array, Reason
from solver.comparison.scenarios.strawberry import METHODS, N_MM_IN_J
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import (
    Mechanism,
    Point,
    Posture,
    link_points,
    load_mechanism,
)
from solver.comparison.strawberry.table_3 import PLANT_CENTRE_M, PLANT_RADIUS_M, table_3

TABLE_COLOUR, GANTRY_COLOUR, BED_COLOUR = "#b9bcc2", "#5b6472", "#8a6f55"
CANOPY_COLOUR, TARGET_COLOUR = "#2e9e5b", "#e0457b"
ARM_COLOURS = ("#274690", "#3f7cac", "#f08a24")  # l1, l2, l3
BED_HALF_M = (0.14, 0.2)
BED_HEIGHT_M = 0.06
SHOWN = ("as", "ssas", "ncos")
ELEVATION_DEG, AZIMUTH_DEG = 14.0, -62.0


def draw_poses(
    target: Point, postures: Mapping[str, Posture], mechanism: Mechanism | None = None
) -> Figure:
    """A column a method: the whole mechanism above, the arm at the plant below.

    Args:
        target: where the tip shall be, in F0 [m].
        postures: at least one posture at it, by method.
        mechanism: the one that ships, unless another is given.

    The plant is the sphere on which Table 3's targets lie. The bed below it shows where the ground
    is; its size is not printed.
    """
    m = mechanism or load_mechanism()
    count = len(postures)
    figure = Figure(figsize=(5.0 * count, 9.0), facecolor="white")
    figure.subplots_adjust(left=0.0, right=0.98, bottom=0.11, top=0.93, wspace=0.0, hspace=0.0)
    for column, (method, posture) in enumerate(postures.items()):
        whole: Axes3D = figure.add_subplot(2, count, 1 + column, projection="3d")
        close: Axes3D = figure.add_subplot(2, count, 1 + count + column, projection="3d")
        for axes in (whole, close):
            axes.computed_zorder = False
            axes.view_init(elev=ELEVATION_DEG, azim=AZIMUTH_DEG)
        _draw_bed(whole, m)
        _draw_plant(whole, target)
        _draw_table(whole, m, posture)
        _draw_arm(whole, m, posture, width=4.0)
        _draw_plant(close, target)
        _draw_column(close, posture, close=True)
        _draw_arm(close, m, posture, width=6.5)
        _frame_whole(whole, m)
        _frame_close(close)
        index = energy_index(m, posture) * N_MM_IN_J
        whole.set_title(f"{method}: J = {index:.1f} N mm", fontsize=14, y=0.97)
        close.set_title(_in_words(posture), fontsize=11, y=-0.06)
    figure.legend(*close.get_legend_handles_labels(), loc="lower center", ncols=6, frameon=False)
    place = ", ".join(f"{value * 1000:g}" for value in target)
    figure.suptitle(
        f"Strawberry mechanism at [{place}] mm: whole, and the arm at the plant", fontsize=16
    )
    return figure


def _in_words(q: Posture) -> str:
    slides = "  ".join(
        f"s{name} {value * 1000:.1f}" for name, value in zip((10, 21, 32), q[:3], strict=True)
    )
    theta, beta = math.degrees(q.theta_rad), math.degrees(q.beta_rad)
    return f"{slides} mm\nθ {theta:.1f}°  β {beta:.1f}°"


def _draw_bed(axes: Axes3D, m: Mechanism) -> None:
    top = PLANT_CENTRE_M[2] - PLANT_RADIUS_M
    narrow, wide = BED_HALF_M
    x = PLANT_CENTRE_M[0]
    profile = [
        (x - narrow, top),
        (x + narrow, top),
        (x + wide, top - BED_HEIGHT_M),
        (x - wide, top - BED_HEIGHT_M),
    ]
    front, back = (
        [(px, y, pz) for px, pz in profile] for y in (m.s10.lower - 0.03, m.s10.upper + 0.03)
    )
    sides = [[front[i], front[i - 1], back[i - 1], back[i]] for i in range(4)]
    axes.add_collection3d(
        Poly3DCollection(
            [back, *sides, front], facecolor=BED_COLOUR, edgecolor="#6f5944", alpha=0.35, zorder=1
        )
    )


def _draw_plant(axes: Axes3D, target: Point) -> None:
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(-np.pi / 2, np.pi / 2, 25))
    shape = np.array((np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)))
    x, y, z = np.array(PLANT_CENTRE_M)[:, None, None] + PLANT_RADIUS_M * shape
    axes.plot_surface(x, y, z, color=CANOPY_COLOUR, alpha=0.13, linewidth=0, zorder=2)
    axes.plot_wireframe(
        x, y, z, rstride=4, cstride=4, color=CANOPY_COLOUR, alpha=0.28, linewidth=0.6, zorder=2
    )
    axes.scatter(*target, s=130, color=TARGET_COLOUR, edgecolor="white", zorder=9, label="target")


def _draw_table(axes: Axes3D, m: Mechanism, q: Posture) -> None:
    """Rails along y, the beam that s10 moves along them, the carriage that s21 moves along it."""
    (left, right), (near, far) = m.s21, m.s10
    for x in (left, right):
        axes.plot((x, x), (near, far), (0, 0), color=TABLE_COLOUR, linewidth=5, zorder=3)
    for y in (near, far):
        axes.plot((left, right), (y, y), (0, 0), color=TABLE_COLOUR, linewidth=2, zorder=3)
    beam = (q.s10_m, q.s10_m)
    axes.plot((left, right), beam, (0, 0), color=GANTRY_COLOUR, linewidth=4, zorder=4)
    _draw_column(axes, q)


def _draw_column(axes: Axes3D, q: Posture, *, close: bool = False) -> None:
    top = -q.s32_m + 0.03 if close else 0.0
    if not close:
        axes.scatter(q.s21_m, q.s10_m, 0.0, s=70, marker="s", color=GANTRY_COLOUR, zorder=5)
    axes.plot(
        (q.s21_m, q.s21_m),
        (q.s10_m, q.s10_m),
        (top, -q.s32_m),
        color=GANTRY_COLOUR,
        linewidth=7 if close else 4,
        solid_capstyle="butt",
        zorder=5,
        label="z slide" if close else None,
    )


def _draw_arm(axes: Axes3D, m: Mechanism, q: Posture, width: float) -> None:
    points = link_points(m, q)
    offset = points[:2]
    axes.plot(
        *offset.T,
        color=GANTRY_COLOUR,
        linewidth=width / 3,
        linestyle=":",
        zorder=6,
        label="offsets (assumed)",
    )
    for number, colour in enumerate(ARM_COLOURS, start=1):
        link = points[number : number + 2]
        axes.plot(
            *link.T,
            color=colour,
            linewidth=width,
            solid_capstyle="round",
            zorder=7,
            label=f"$l_{number}$",
        )
    joints: Array = points[2:4]
    axes.scatter(*joints.T, s=9 * width, color="white", edgecolor=ARM_COLOURS[0], zorder=8)


def _frame_whole(axes: Axes3D, m: Mechanism) -> None:
    lowest = PLANT_CENTRE_M[2] - PLANT_RADIUS_M - BED_HEIGHT_M
    _frame(
        axes,
        np.array(
            (
                (m.s21.lower - 0.02, m.s21.upper + 0.02),
                (m.s10.lower - 0.04, m.s10.upper + 0.04),
                (lowest, 0.03),
            )
        ),
        zoom=1.28,
    )


def _frame_close(axes: Axes3D) -> None:
    x, y, z = PLANT_CENTRE_M
    sides = ((x - 0.17, x + 0.13), (y - 0.25, y + 0.13), (z - 0.11, z + 0.27))
    _frame(axes, np.array(sides), zoom=1.35)
    axes.set_axis_off()


def _frame(axes: Axes3D, ranges: Array, zoom: float) -> None:
    axes.set_xlim(*ranges[0])
    axes.set_ylim(*ranges[1])
    axes.set_zlim(*ranges[2])
    axes.set_box_aspect(ranges[:, 1] - ranges[:, 0], zoom=zoom)
    for name, axis in zip("xyz", (axes.xaxis, axes.yaxis, axes.zaxis), strict=True):
        axis.set_major_locator(MultipleLocator(0.2))
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.set_tick_params(labelsize=7, pad=-1)
        axis.set_label_text(f"{name} [m]", fontsize=8)
    axes.grid(True, alpha=0.3)


def main(arguments: list[str]) -> None:
    """Write the picture of a target of Table 3, by default that of S's figures 4 to 6."""
    row = table_3()[int(arguments[1]) - 1 if len(arguments) > 1 else 0]
    postures = {}
    for method in SHOWN:
        answer = METHODS[method](load_mechanism(), row.target)
        if isinstance(answer, Reason):
            raise SystemExit(f"{method} has no posture at {row.label}: {answer.detail}")
        postures[method] = answer.posture
    draw_poses(row.target, postures).savefig(arguments[0], dpi=90)


if __name__ == "__main__":
    main(sys.argv[1:])
