"""Kernels: whether an arm touches obstacles, itself or what it stands on, and how near it comes."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple, cast

import numpy as np

from solver.compiled import inlined, kernel
from solver.kinematics.numerical import locate
from solver.robots.model import Array
from solver.scene.distances import (
    between_capsules,
    distance_to_box,
    distance_to_plane,
    may_be_within,
    squared_between,
)
from solver.scene.grid import HALF_DIAGONAL, first_and_last
from solver.scene.tolerances import GRID_STEP_CELLS, GUESSED_ITEMS, LEAST_FREE_CELLS

NOBODY = cast(int, np.int64(-1))
"""The number of no obstacle, and of no shape."""


class BodyScratch(NamedTuple):
    """Working memory: frames of links, and the arm's capsules in the base frame."""

    frames: Array
    placed: Array


@kernel
def body_scratch(body):
    """Working memory for an arm's body."""
    return BodyScratch(np.empty((len(body.chain.a) + 1, 4, 4)), np.empty_like(body.capsules))


@kernel
def place_body(body, q, scratch):
    """Writes where the arm's capsules are at a posture q, shape (joints,) [rad or m]."""
    frames, placed = scratch.frames, scratch.placed
    locate(body.chain, q, frames)
    for n in range(len(body.links)):
        frame, own, row = frames[body.links[n]], body.capsules[n], placed[n]
        for i in range(3):
            x, y, z = frame[i, 0], frame[i, 1], frame[i, 2]
            row[i] = x * own[0] + y * own[1] + z * own[2] + frame[i, 3]
            row[3 + i] = x * own[3] + y * own[4] + z * own[5]
            row[7 + i] = row[i] + row[3 + i] / 2
        row[6], row[10] = own[6], own[10]


@inlined
def balls_within(one, balls, most):
    """How many balls around obstacles may be within `most` of that around a capsule."""
    x, y, z, around, found = one[7], one[8], one[9], one[10] + most, 0
    # A sum, so that the compiler makes a vector loop of it.
    for m in range(balls.shape[1]):
        dx, dy, dz, near = x - balls[0, m], y - balls[1, m], z - balls[2, m], around + balls[3, m]
        found += dx * dx + dy * dy + dz * dz < near * near
    return found


@kernel
def nearest_of_rows(one, rows, balls, most, number):
    """The least distance below `most` of a capsule to rows, and which row; else what is given."""
    for m in range(balls.shape[1]):
        x, y, z = one[7] - balls[0, m], one[8] - balls[1, m], one[9] - balls[2, m]
        near = max(one[10] + balls[3, m] + most, 0.0)
        if x * x + y * y + z * z < near * near:
            apart = between_capsules(one, rows[m])
            if apart < most:
                most, number = apart, m
    return most, number


@kernel
def nearest_of_boxes(one, boxes, most, number):
    """The same of boxes."""
    for m in range(len(boxes)):
        box = boxes[m]
        x, y, z = one[7] - box[0], one[8] - box[1], one[9] - box[2]
        near = max(one[10] + box[15] + most, 0.0)
        if x * x + y * y + z * z < near * near:
            apart = distance_to_box(one, box) - one[6]
            if apart < most:
                most, number = apart, m
    return most, number


@kernel
def nearest_of_planes(one, planes, most, number):
    """The same of planes."""
    for m in range(len(planes)):
        apart = distance_to_plane(one, planes[m])
        if apart - one[6] < most:
            most, number = apart - one[6], m
    return most, number


@inlined
def cell_at(grid, x, y, z):
    """The cell that a place is in, or the one nearest to it, and the squared distance to it."""
    outside, number, per_cell = 0.0, 0, 1.0 / grid.cell
    for i, place in enumerate((x, y, z)):
        cells = (place - grid.origin[i]) * per_cell
        held = min(max(cells, 0.0), float(grid.counts[i]))
        outside += (cells - held) * (cells - held)
        number = number * grid.counts[i] + min(int(held), grid.counts[i] - 1)
    return number, outside * grid.cell * grid.cell


@kernel
def gap_at(grid, x, y, z):
    """Least distance of a place to whatever the grid has [m]; 0 where it may be near."""
    number, outside = cell_at(grid, x, y, z)
    return max(math.sqrt(outside), float(grid.gaps[number]))


@kernel
def guess_in_grid(one, rows, grid, most, number):
    """The same of little that is in the cells nearest to some places of the axis."""
    for share in (0.0, 0.5, 1.0):
        x, y, z = one[0] + share * one[3], one[1] + share * one[4], one[2] + share * one[5]
        here, outside = cell_at(grid, x, y, z)
        if max(math.sqrt(outside), float(grid.gaps[here])) - one[6] >= most:
            continue
        there = grid.nearest[here]
        begin, end = grid.starts[there], grid.starts[there + 1]
        for n in range(begin, min(begin + GUESSED_ITEMS, end)):
            m = grid.items[n]
            apart = between_capsules(one, rows[m])
            if apart < most:
                most, number = apart, m
    return most, number


@kernel
def nearest_in_grid(one, rows, grid, most, number, enough):
    """The same of the capsules in a grid; ends at once where it is below `enough` [m].

    The capsule's axis is gone along from its beginning: as far as nothing can be nearer than what
    is known, or a short way, for which the cells around are looked at.
    """
    length = math.sqrt(one[3] * one[3] + one[4] * one[4] + one[5] * one[5])
    per_metre = 1.0 / length if length > 0.0 else 0.0
    step, done = GRID_STEP_CELLS * grid.cell, 0.0
    while done <= length:
        share = done * per_metre
        x, y, z = one[0] + share * one[3], one[1] + share * one[4], one[2] + share * one[5]
        # Inside something the gap is zero, however deep.
        free = gap_at(grid, x, y, z) - max(one[6] + most, 0.0)
        if free > LEAST_FREE_CELLS * grid.cell:
            done += free
            continue
        ahead = min(step, length - done) * per_metre
        most, number = nearest_around(
            one, x, y, z, ahead * one[3], ahead * one[4], ahead * one[5],
            rows, grid, most, number, enough,
        )  # fmt: skip
        if most < enough or done + step >= length:
            break
        done += step
    return most, number


@kernel
def nearest_around(one, x, y, z, dx, dy, dz, rows, grid, most, number, enough):
    """The same of what is in the cells around a stretch of the capsule's axis, (x, y, z) + s d."""
    # An axis that is deeper inside something than that is in its cells itself.
    reach = max(one[6] + most, 0.0)
    cell, origin, counts, per_cell = grid.cell, grid.origin, grid.counts, 1.0 / grid.cell
    near = reach + HALF_DIAGONAL * cell
    i_first, i_end = first_and_last(
        min(x, x + dx) - reach, max(x, x + dx) + reach, origin[0], per_cell, counts[0]
    )
    j_first, j_end = first_and_last(
        min(y, y + dy) - reach, max(y, y + dy) + reach, origin[1], per_cell, counts[1]
    )
    k_first, k_end = first_and_last(
        min(z, z + dz) - reach, max(z, z + dz) + reach, origin[2], per_cell, counts[2]
    )
    for i in range(i_first, i_end):
        for j in range(j_first, j_end):
            row, k = (i * counts[1] + j) * counts[2], k_first - 1
            while k + 1 < k_end:
                k += 1
                begin, end = grid.starts[row + k], grid.starts[row + k + 1]
                if begin == end:
                    # As far as nothing is near, cells behind it are empty too.
                    k += int(grid.gaps[row + k] * per_cell)
                    continue
                apart = squared_between(
                    x, y, z, dx, dy, dz,
                    origin[0] + (i + 0.5) * cell, origin[1] + (j + 0.5) * cell,
                    origin[2] + (k + 0.5) * cell, 0.0, 0.0, 0.0,
                )  # fmt: skip
                if apart > near * near:
                    continue
                for n in range(begin, end):
                    m = grid.items[n]
                    if may_be_within(one, rows[m], most):
                        apart = between_capsules(one, rows[m])
                        if apart < most:
                            most, number = apart, m
                            near = max(one[6] + most, 0.0) + HALF_DIAGONAL * cell
                            if most < enough:
                                return most, number
    return most, number


@kernel
def touches(body, obstacles, clearance, q, scratch):
    """Whether a posture, shape (joints,), is nearer than `clearance` [m] to some obstacle."""
    place_body(body, q, scratch)
    _, shape, _ = nearest_of_placed(scratch.placed, obstacles, clearance, clearance)
    return shape >= 0


@kernel
def nearest(body, obstacles, most, q, scratch):
    """The nearest pair at a posture: distance, shape of the arm, obstacle of the scene.

    Depth is below zero. `most`, NOBODY and NOBODY where nothing is nearer than that [m].
    """
    place_body(body, q, scratch)
    return nearest_of_placed(scratch.placed, obstacles, most, -math.inf)


@kernel
def nearest_of_placed(placed, obstacles, most, enough):
    """`nearest` of capsules in the base frame; ends at once with one that is below `enough` [m]."""
    shape, obstacle = NOBODY, NOBODY
    capsules, balls, boxes, planes = (
        obstacles.capsules, obstacles.balls, obstacles.boxes, obstacles.planes,
    )  # fmt: skip
    for n in range(len(placed)):
        one = placed[n]
        if balls_within(one, balls, most) > 0:
            most, number = nearest_of_rows(one, capsules, balls, most, NOBODY)
            if number >= 0:
                shape, obstacle = n, obstacles.of_capsules[number]
        if len(boxes) > 0:
            most, number = nearest_of_boxes(one, boxes, most, NOBODY)
            if number >= 0:
                shape, obstacle = n, obstacles.of_boxes[number]
        if len(planes) > 0:
            most, number = nearest_of_planes(one, planes, most, NOBODY)
            if number >= 0:
                shape, obstacle = n, obstacles.of_planes[number]
        if len(obstacles.gridded) > 0 and most >= enough:
            if most > enough:
                most, number = guess_in_grid(one, obstacles.gridded, obstacles.grid, most, NOBODY)
                if number >= 0:
                    shape, obstacle = n, obstacles.of_gridded[number]
            most, number = nearest_in_grid(
                one, obstacles.gridded, obstacles.grid, most, NOBODY, enough
            )
            if number >= 0:
                shape, obstacle = n, obstacles.of_gridded[number]
        if most < enough:
            break
    return most, shape, obstacle


@kernel
def nearest_of_itself(body, most, q, scratch):
    """The nearest pair of the arm and itself, or what it stands on, that may not meet.

    Distance, shape of the arm, and the other: a shape, behind those a fixed capsule, behind those a
    fixed box. `most`, NOBODY and NOBODY where none is nearer than that [m].
    """
    place_body(body, q, scratch)
    shape, other, placed = NOBODY, NOBODY, scratch.placed
    for n in range(len(body.pairs)):
        j, k = body.pairs[n]
        apart = between_capsules(placed[j], placed[k])
        if apart < most:
            most, shape, other = apart, j, k
    for n in range(len(body.fixed_pairs)):
        j, k = body.fixed_pairs[n]
        apart = between_capsules(placed[j], body.fixed_capsules[k])
        if apart < most:
            most, shape, other = apart, j, len(placed) + k
    for n in range(len(body.box_pairs)):
        j, k = body.box_pairs[n]
        most, number = nearest_of_boxes(placed[j], body.fixed_boxes[k : k + 1], most, NOBODY)
        if number >= 0:
            shape, other = j, len(placed) + len(body.fixed_capsules) + k
    return most, shape, other
