"""Triangles drawn on a scanner's own grid of beams, where every depth is that of an exact ray.

A beam at azimuth a and elevation e points along cos(e) (cos(a), sin(a), tan(e)). So each edge of a triangle bounds
tan(e) in a column of beams by a quotient, and the rows within follow from two arc tangents; what the neighbour on the
other side of an edge computes are the same numbers, and no beam falls between them. The inverse range over a row is
n.beam / n.vertex for the normal n.
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
"""A triangle whose plane passes the scanner this near is not seen [m]."""


class Triangles(NamedTuple):
    """Triangles in the scanner's frame."""

    vertices: NDArray[np.float64]
    """(V, 3) [m]"""
    corners: NDArray[np.int32]
    """(T, 3) indices of vertices."""
    sides: NDArray[np.int8]
    """(T,) `BOTH`, `FRONT` or `BACK`."""
    owners: NDArray[np.int32]
    """(T,) what each is part of: a geom id, -1 for a flex or skin; the index of a round body."""


class Grid(NamedTuple):
    """The directions of a panorama."""

    cos_azimuth: NDArray[np.float64]
    """(A,) of the columns, all round at equal steps from azimuth 0."""
    sin_azimuth: NDArray[np.float64]
    cos_elevation: NDArray[np.float64]
    """(E,) of the rows, at equal steps from the top."""
    sin_elevation: NDArray[np.float64]
    top: float
    """Elevation of the first row [rad]."""
    step: float
    """Between rows [rad]."""


class Outlines(NamedTuple):
    """Triangles made ready to be drawn."""

    edges: NDArray[np.float64]
    """(T, 3, 3) normals of the planes through the scanner and each edge, pointing to the triangle's side."""
    planes: NDArray[np.float64]
    """(T, 3) normals, of a length that makes the product with a beam the inverse range [1/m]."""
    distances: NDArray[np.float64]
    """(T,) of the triangles' planes from the scanner [m]; times an inverse range, the cosine of the incidence."""
    windows: NDArray[np.int32]
    """(T, 2) first column, from 0 to A - 1, and last one, which may lie beyond A; before the first if not seen."""
    owners: NDArray[np.int32]
    """(T,) as `Triangles` has them."""


class Strip(NamedTuple):
    """What has been drawn on some columns."""

    first: int
    """Column."""
    inverse_range: NDArray[np.float32]
    """(columns, E) [1/m]"""
    cosine: NDArray[np.float32]
    """(columns, E) of the angle between beam and normal."""
    geoms: NDArray[np.int32]
    """(columns, E)"""


def outlined(triangles: Triangles, columns: int) -> Outlines:
    """Make triangles ready to be drawn on a grid of so many columns."""
    count = len(triangles.corners)
    outlines = Outlines(
        edges=np.empty((count, 3, 3)),
        planes=np.empty((count, 3)),
        distances=np.empty(count),
        windows=np.empty((count, 2), np.int32),
        owners=triangles.owners,
    )
    _outline(triangles, columns, outlines)
    return outlines


@compiled
def _outline(triangles: Triangles, columns: int, outlines: Outlines) -> None:
    for t in range(len(triangles.corners)):
        outlines.windows[t, 0], outlines.windows[t, 1] = 0, -1
        a, b, c = triangles.corners[t]
        p, q, r = triangles.vertices[a], triangles.vertices[b], triangles.vertices[c]
        x, y, z = _cross(q[0] - p[0], q[1] - p[1], q[2] - p[2], r[0] - p[0], r[1] - p[1], r[2] - p[2])
        length = math.sqrt(x * x + y * y + z * z)
        depth = x * p[0] + y * p[1] + z * p[2]  # above 0 where the scanner is behind the triangle
        side = triangles.sides[t]
        if abs(depth) <= _EDGE_ON * length or (side == FRONT and depth > 0) or (side == BACK and depth < 0):
            continue
        outlines.planes[t, 0], outlines.planes[t, 1], outlines.planes[t, 2] = x / depth, y / depth, z / depth
        outlines.distances[t] = abs(depth) / length
        sign = 1.0 if depth > 0 else -1.0
        for k, (start, end) in enumerate(((p, q), (q, r), (r, p))):
            x, y, z = _cross(start[0], start[1], start[2], end[0], end[1], end[2])
            outlines.edges[t, k, 0], outlines.edges[t, k, 1], outlines.edges[t, k, 2] = sign * x, sign * y, sign * z
        outlines.windows[t, 0], outlines.windows[t, 1] = _window(p, q, r, columns)


@compiled
def _cross(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> tuple[float, float, float]:
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@compiled
def _window(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64], columns: int) -> tuple[int, int]:
    """First and last column that a triangle can be seen in: all of them where it is above or below the scanner."""
    start = math.atan2(p[1], p[0])
    second = math.atan2(q[1], q[0])
    third = math.atan2(r[1], r[0])
    to_second, to_third, back = _turn(second - start), _turn(third - second), _turn(start - third)
    if abs(to_second + to_third + back) > 1 or max(abs(to_second), abs(to_third), abs(back)) > 3.14159:
        return 0, columns - 1
    per_radian = columns / (2 * math.pi)
    first = int(math.floor((start + min(0.0, to_second, to_second + to_third)) * per_radian))
    last = int(math.ceil((start + max(0.0, to_second, to_second + to_third)) * per_radian))
    shift = first % columns - first
    return first + shift, last + shift


@compiled
def _turn(angle: float) -> float:
    """The shorter way round [rad]."""
    return angle - 2 * math.pi * round(angle / (2 * math.pi))


@compiled
def _rows_within(edges: NDArray[np.float64], cos: float, sin: float, grid: Grid) -> tuple[int, int]:
    """First and last row of the beams of a column that pass through a triangle."""
    low, high = -np.inf, np.inf  # of the tangent of the elevation
    for k in range(3):
        level, upward = edges[k, 0] * cos + edges[k, 1] * sin, edges[k, 2]
        if upward > 0:
            low = max(low, -level / upward)
        elif upward < 0:
            high = min(high, -level / upward)
        elif level < 0:
            return 0, -1
    if low > high:
        return 0, -1
    first = math.ceil((grid.top - math.atan(high)) / grid.step)
    last = math.floor((grid.top - math.atan(low)) / grid.step)
    return max(int(first), 0), min(int(last), len(grid.cos_elevation) - 1)


@compiled
def draw_facets(outlines: Outlines, grid: Grid, strip: Strip) -> None:
    """Draw triangles on a strip, before what lies behind them.

    Args:
        outlines: the triangles, owned by geoms.
        grid: all beams.
        strip: some of its columns; changed in place.
    """
    columns, end = len(grid.cos_azimuth), strip.first + len(strip.geoms)
    for t in range(len(outlines.windows)):
        for turn in (0, columns):  # a window that begins before the grid's end may go on at its start
            start = max(outlines.windows[t, 0] - turn, strip.first)
            for column in range(start, min(outlines.windows[t, 1] - turn + 1, end)):
                cos, sin = grid.cos_azimuth[column], grid.sin_azimuth[column]
                first, last = _rows_within(outlines.edges[t], cos, sin, grid)
                level = outlines.planes[t, 0] * cos + outlines.planes[t, 1] * sin
                upward, distance, owner = outlines.planes[t, 2], outlines.distances[t], outlines.owners[t]
                k = column - strip.first
                inverse_range, cosine, geoms = strip.inverse_range[k], strip.cosine[k], strip.geoms[k]
                for row in range(first, last + 1):
                    value = level * grid.cos_elevation[row] + upward * grid.sin_elevation[row]
                    near = np.float32(value)
                    nearer = near > inverse_range[row]
                    inverse_range[row] = near if nearer else inverse_range[row]
                    cosine[row] = np.float32(value * distance) if nearer else cosine[row]
                    geoms[row] = owner if nearer else geoms[row]


def spans(outlines: Outlines, grid: Grid, first: int, end: int) -> NDArray[np.int32]:
    """Which beams of the columns `first` to `end` - 1 pass through triangles.

    Returns:
        (N, 4) owner of a triangle, column, first and last row.
    """
    return np.asarray(_spans(outlines, grid, first, end))


@compiled
def _spans(outlines: Outlines, grid: Grid, first: int, end: int) -> NDArray[np.int32]:
    columns, count = len(grid.cos_azimuth), 0
    for t in range(len(outlines.windows)):
        for turn in (0, columns):
            wide = min(outlines.windows[t, 1] - turn + 1, end) - max(outlines.windows[t, 0] - turn, first)
            count += max(wide, 0)
    found = np.empty((count, 4), np.int32)
    count = 0
    for t in range(len(outlines.windows)):
        for turn in (0, columns):
            start = max(outlines.windows[t, 0] - turn, first)
            for column in range(start, min(outlines.windows[t, 1] - turn + 1, end)):
                cos, sin = grid.cos_azimuth[column], grid.sin_azimuth[column]
                top, bottom = _rows_within(outlines.edges[t], cos, sin, grid)
                if top <= bottom:
                    found[count, 0], found[count, 1] = outlines.owners[t], column
                    found[count, 2], found[count, 3] = top, bottom
                    count += 1
    return found[:count]
