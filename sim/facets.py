"""Triangles drawn on a grid of beams, where every depth is that of an exact ray.

The beam of a column and a row points along level (ahead, aside, rise / level): in a column, each edge of a triangle
bounds rise / level by a quotient, and the rows within follow. What the neighbour on the other side of an edge computes
are the same numbers, so no beam falls between them. Along a beam the inverse range is n.beam / n.vertex for the
triangle's normal n.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled

BOTH, FRONT, BACK = range(3)
"""Sides on which a beam meets a triangle; seen from its front, the corners run anticlockwise."""

_EDGE_ON = 1e-7
"""A triangle whose plane passes the origin of the beams this near is not met [m]."""


class Triangles(NamedTuple):
    """Triangles in the frame of the beams."""

    vertices: NDArray[np.float64]
    """(V, 3) [m]"""
    corners: NDArray[np.int32]
    """(T, 3) indices of vertices."""
    sides: NDArray[np.int8]
    """(T,) `BOTH`, `FRONT` or `BACK`."""
    owners: NDArray[np.int32]
    """(T,) what each is part of: a geom id, -1 for a flex or skin; the index of a round body."""


class Grid(NamedTuple):
    """Beams from the origin: (ahead[column] level[row], aside[column] level[row], rise[row])."""

    ahead: NDArray[np.float64]
    """(C,)"""
    aside: NDArray[np.float64]
    """(C,)"""
    level: NDArray[np.float64]
    """(R,)"""
    rise: NDArray[np.float64]
    """(R,)"""
    first_column: float
    """Azimuth of the first column [rad]; in a picture its tangent, aside / ahead."""
    column_step: float
    """From each column to the next."""
    first_row: float
    """Elevation of the first row [rad]; in a picture its tangent, rise / level."""
    row_step: float
    is_panorama: bool
    """Columns all round at equal angles; otherwise a picture, columns and rows at equal tangents."""


class Outlines(NamedTuple):
    """The triangles in sight, ready to be drawn."""

    edges: NDArray[np.float64]
    """(T, 3, 3) normals of the planes through the origin and each edge, pointing to the triangle's side."""
    planes: NDArray[np.float64]
    """(T, 3) normals, of a length that makes the product with a beam its inverse range [1/m]."""
    windows: NDArray[np.int32]
    """(T, 2) first column and last one, which may lie a turn beyond the grid's last."""
    owners: NDArray[np.int32]
    """(T,) as `Triangles` has them."""


class Strip(NamedTuple):
    """What has been drawn on some columns."""

    first: int
    """Column."""
    inverse_range: NDArray[np.float32]
    """(columns, R) in beams' lengths [1/m]; 0 where there is nothing."""
    surfaces: NDArray[np.int32]
    """(columns, R) index of a triangle, or of a round body plus the number of triangles; -1 where there is nothing."""


def panorama(elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> Grid:
    """Unit beams along (E,) elevations at equal steps and (A,) azimuths all round at equal steps [rad]."""
    return Grid(
        *(np.cos(azimuths), np.sin(azimuths), np.cos(elevations), np.sin(elevations)),
        *(float(azimuths[0]), 2 * math.pi / len(azimuths), float(elevations[0]), _step(elevations)),
        is_panorama=True,
    )


def picture(asides: NDArray[np.float64], rises: NDArray[np.float64]) -> Grid:
    """Beams (1, aside, rise) to the pixels of a picture, both at equal steps; inverse ranges are inverse depths."""
    return Grid(
        *(np.ones(len(asides)), asides, np.ones(len(rises)), rises),
        *(float(asides[0]), _step(asides), float(rises[0]), _step(rises)),
        is_panorama=False,
    )


def _step(values: NDArray[np.float64]) -> float:
    assert len(values) > 1, "one row or column has no step"
    return float(values[-1] - values[0]) / (len(values) - 1)


def outlined(triangles: Triangles, grid: Grid) -> Outlines:
    """Make triangles ready to be drawn, those that beams of the grid may meet."""
    azimuths = np.arctan2(triangles.vertices[:, 1], triangles.vertices[:, 0])
    windows = np.empty((len(triangles.corners), 2), np.int32)
    _find_windows(triangles, azimuths, grid, windows)
    seen = np.flatnonzero(windows[:, 0] <= windows[:, 1])
    outlines = Outlines(np.empty((len(seen), 3, 3)), np.empty((len(seen), 3)), windows[seen], triangles.owners[seen])
    _outline(triangles.vertices, triangles.corners[seen], outlines.edges, outlines.planes)
    return outlines


@compiled
def _find_windows(triangles: Triangles, azimuths: NDArray[np.float64], grid: Grid, windows: NDArray[np.int32]) -> None:
    """Set (T, 2) first and last columns; the last one lies before the first where a triangle cannot be met."""
    for t in range(len(triangles.corners)):
        a, b, c = triangles.corners[t, 0], triangles.corners[t, 1], triangles.corners[t, 2]
        first, last = _window(azimuths[a], azimuths[b], azimuths[c], grid)
        if first <= last:
            side = triangles.sides[t]
            depth, length = _facing(triangles.vertices[a], triangles.vertices[b], triangles.vertices[c])[:2]
            if abs(depth) <= _EDGE_ON * length or (side == FRONT and depth > 0) or (side == BACK and depth < 0):
                last = first - 1
        windows[t, 0], windows[t, 1] = first, last


@compiled
def _outline(
    vertices: NDArray[np.float64],
    corners: NDArray[np.int32],
    edges: NDArray[np.float64],
    planes: NDArray[np.float64],
) -> None:
    for t in range(len(corners)):
        p, q, r = vertices[corners[t, 0]], vertices[corners[t, 1]], vertices[corners[t, 2]]
        depth, _, x, y, z = _facing(p, q, r)
        planes[t, 0], planes[t, 1], planes[t, 2] = x / depth, y / depth, z / depth
        sign = 1.0 if depth > 0 else -1.0
        for k, (start, end) in enumerate(((p, q), (q, r), (r, p))):
            x, y, z = _cross((start[0], start[1], start[2]), (end[0], end[1], end[2]))
            edges[t, k, 0], edges[t, k, 1], edges[t, k, 2] = sign * x, sign * y, sign * z


@compiled
def _facing(
    p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]
) -> tuple[float, float, float, float, float]:
    """The normal of a triangle, before it its length and its product with a corner: above 0 seen from behind."""
    x, y, z = _cross((q[0] - p[0], q[1] - p[1], q[2] - p[2]), (r[0] - p[0], r[1] - p[1], r[2] - p[2]))
    return x * p[0] + y * p[1] + z * p[2], math.sqrt(x * x + y * y + z * z), x, y, z


@compiled
def _cross(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def _window(a: float, b: float, c: float, grid: Grid) -> tuple[int, int]:
    """First and last column that a triangle can be seen in, from the azimuths of its corners [rad].

    All of them where it is straight above or below the origin.
    """
    to_b, to_c, back = _turn(b - a), _turn(c - b), _turn(a - c)
    if abs(to_b + to_c + back) > 1 or max(abs(to_b), abs(to_c), abs(back)) > 3.14159:
        return 0, len(grid.ahead) - 1
    low, high = a + min(0.0, to_b, to_b + to_c), a + max(0.0, to_b, to_b + to_c)
    if grid.is_panorama:
        first = int(math.floor((low - grid.first_column) / grid.column_step))
        last = int(math.ceil((high - grid.first_column) / grid.column_step))
        return first % len(grid.ahead), last - first + first % len(grid.ahead)
    end = grid.first_column + (len(grid.ahead) - 1) * grid.column_step
    limit = math.atan(max(abs(grid.first_column), abs(end)) + 1e-3)
    left, right = np.inf, -np.inf
    for turn in (-2 * math.pi, 0.0, 2 * math.pi):
        if max(low + turn, -limit) <= min(high + turn, limit):
            left, right = min(left, max(low + turn, -limit)), max(right, min(high + turn, limit))
    if left > right:
        return 0, -1
    one = (math.tan(left) - grid.first_column) / grid.column_step
    other = (math.tan(right) - grid.first_column) / grid.column_step
    return max(int(math.floor(min(one, other))), 0), min(int(math.ceil(max(one, other))), len(grid.ahead) - 1)


@compiled
def _turn(angle: float) -> float:
    """The shorter way round [rad]."""
    return angle - 2 * math.pi * round(angle / (2 * math.pi))


@compiled
def _rows_within(edges: NDArray[np.float64], ahead: float, aside: float, grid: Grid) -> tuple[int, int]:
    """First and last row of the beams of a column that pass through a triangle."""
    low, high = -np.inf, np.inf  # of rise / level
    for k in range(3):
        level, upward = edges[k, 0] * ahead + edges[k, 1] * aside, edges[k, 2]
        if upward > 0:
            low = max(low, -level / upward)
        elif upward < 0:
            high = min(high, -level / upward)
        elif level < 0:
            return 0, -1
    if not low <= high:
        return 0, -1
    if grid.is_panorama:
        low, high = math.atan(low), math.atan(high)
    one, other = (low - grid.first_row) / grid.row_step, (high - grid.first_row) / grid.row_step
    rows = float(len(grid.level))
    first, last = min(max(min(one, other), 0.0), rows), max(min(max(one, other), rows - 1), -1.0)
    return int(math.ceil(first)), int(math.floor(last))


@compiled
def _columns_within(outlines: Outlines, t: int, turn: int, first: int, end: int) -> tuple[int, int]:
    """Those of the columns `first` to `end` - 1 that a triangle can be seen in, as a range.

    A window that begins before the grid's end may go on at its start: it is looked at once, and once a turn back.
    """
    return max(outlines.windows[t, 0] - turn, first), min(outlines.windows[t, 1] - turn + 1, end)


@compiled
def draw_facets(outlines: Outlines, grid: Grid, strip: Strip) -> None:
    """Draw triangles on a strip, before what lies behind them.

    Args:
        outlines: the triangles.
        grid: all beams.
        strip: some of its columns; changed in place.
    """
    columns, end = len(grid.ahead), strip.first + len(strip.surfaces)
    for t in range(len(outlines.windows)):
        for turn in (0, columns):
            start, stop = _columns_within(outlines, t, turn, strip.first, end)
            for column in range(start, stop):
                ahead, aside, k = grid.ahead[column], grid.aside[column], column - strip.first
                first, last = _rows_within(outlines.edges[t], ahead, aside, grid)
                level = outlines.planes[t, 0] * ahead + outlines.planes[t, 1] * aside
                upward, inverse_range, surfaces = outlines.planes[t, 2], strip.inverse_range[k], strip.surfaces[k]
                for row in range(first, last + 1):
                    near = np.float32(level * grid.level[row] + upward * grid.rise[row])
                    nearer = near > inverse_range[row]
                    inverse_range[row] = near if nearer else inverse_range[row]
                    surfaces[row] = t if nearer else surfaces[row]


@compiled
def slopes_of_facets(strip: Strip, outlines: Outlines, slopes: NDArray[np.float32], geoms: NDArray[np.int32]) -> None:
    """Say what lies behind the beams that meet triangles.

    Args:
        strip: all drawn.
        outlines: the triangles, owned by geoms.
        slopes: (3, columns, R) to be set to the triangles' `Outlines.planes`, and to 0 elsewhere.
        geoms: (columns, R) to be set to the geom ids, and to -1 elsewhere.
    """
    for k in range(len(strip.surfaces)):
        for row in range(strip.surfaces.shape[1]):
            t = strip.surfaces[k, row]
            if 0 <= t < len(outlines.owners):
                geoms[k, row] = outlines.owners[t]
                for i in range(3):
                    slopes[i, k, row] = outlines.planes[t, i]
            else:
                geoms[k, row] = -1
                for i in range(3):
                    slopes[i, k, row] = 0


@compiled
def spans(outlines: Outlines, grid: Grid, first: int, end: int) -> NDArray[np.int32]:
    """Which beams of the columns `first` to `end` - 1 pass through triangles.

    Returns:
        (N, 4) owner of a triangle, column, first and last row.
    """
    columns, count = len(grid.ahead), 0
    for t in range(len(outlines.windows)):
        for turn in (0, columns):
            start, stop = _columns_within(outlines, t, turn, first, end)
            count += max(stop - start, 0)
    found = np.empty((count, 4), np.int32)
    count = 0
    for t in range(len(outlines.windows)):
        for turn in (0, columns):
            start, stop = _columns_within(outlines, t, turn, first, end)
            for column in range(start, stop):
                top, bottom = _rows_within(outlines.edges[t], grid.ahead[column], grid.aside[column], grid)
                if top <= bottom:
                    found[count, 0], found[count, 1] = outlines.owners[t], column
                    found[count, 2], found[count, 3] = top, bottom
                    count += 1
    return found[:count]
