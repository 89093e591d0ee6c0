"""Outlines of rooms, and where in them a robot scans."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Corners = NDArray[np.float64]
"""(P, 2) of a floor, clockwise seen from above [m]."""

_LEAST_DISTANCE = 1.6
"""Of a scan place from every wall: the scanner measures from 1.5 m on [m]."""


def rectangle(width: float, depth: float) -> Corners:
    """Four walls: the first `width` long, the second `depth`."""
    return np.array([[0, depth], [width, depth], [width, 0], [0, 0]], float)


def trapezoid(width: float, depth: float, slant: float) -> Corners:
    """A rectangle whose second wall leans out by `slant` at its far end."""
    return np.array([[0, depth], [width, depth], [width + slant, 0], [0, 0]], float)


def chamfered(width: float, depth: float, cut: float) -> Corners:
    """A rectangle with its last corner cut off: five walls, the last the short one."""
    return np.array([[0, depth], [width, depth], [width, 0], [cut, 0], [0, cut]], float)


def angled(width: float, depth: float, notch: tuple[float, float]) -> Corners:
    """An L: a rectangle less a notch at its last corner; the first corner is seen from all others but the notch's."""
    return np.array([[0, depth], [width, depth], [width, 0], [notch[0], 0], [notch[0], notch[1]], [0, notch[1]]], float)


def grown(corners: Corners, by: float) -> Corners:
    """The outline with all walls moved out [m]."""
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    after = np.column_stack([-along[:, 1], along[:, 0]])  # outward: clockwise, the room is on the right
    before = np.roll(after, 1, axis=0)
    return np.asarray(corners + by * (before + after) / (1 + np.einsum("pk,pk->p", before, after))[:, None])


def side_lengths(corners: Corners) -> NDArray[np.float64]:
    """(P,) lengths of the walls [m]."""
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1))


def reflex_corners(corners: Corners) -> NDArray[np.bool_]:
    """(P,) marks the corners at which the room has more than a half turn."""
    after, before = np.roll(corners, -1, axis=0) - corners, corners - np.roll(corners, 1, axis=0)
    return np.asarray(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 1e-9)


def scan_places(
    rng: np.random.Generator,
    corners: Corners,
    count: int,
    *,
    seen: NDArray[np.float64],
    avoid: Sequence[tuple[float, float, float]] = (),
) -> tuple[tuple[float, float, float], ...]:
    """Choose places to scan from, far from walls and from each other.

    Args:
        rng: source of chance.
        corners: of the floor.
        count: of places.
        seen: (N, 2) points of walls that each place must see [m].
        avoid: discs that are taken: x, y, radius [m].

    Returns:
        x, y [m] and heading [rad] of each.
    """
    low, high = corners.min(axis=0), corners.max(axis=0)
    spots = rng.uniform(low, high, (4000, 2))
    free = _distance(spots, corners) >= _LEAST_DISTANCE
    free &= _inside(spots, corners)
    for x, y, radius in avoid:
        free &= np.hypot(spots[:, 0] - x, spots[:, 1] - y) >= radius
    for point in seen:
        free &= ~_crosses(spots, point, corners)
    spots = spots[free][:150]
    if not len(spots):
        raise ValueError("no place in the room is far enough from its walls")
    chosen = [spots[0]]
    while len(chosen) < count:
        nearest = np.min([np.linalg.norm(spots - other, axis=1) for other in chosen], axis=0)
        chosen.append(spots[nearest.argmax()])
    return tuple((float(x), float(y), float(rng.uniform(-np.pi, np.pi))) for x, y in chosen)


def _edges(corners: Corners) -> tuple[Corners, Corners]:
    return corners, np.roll(corners, -1, axis=0)


def _distance(spots: NDArray[np.float64], corners: Corners) -> NDArray[np.float64]:
    """(N,) distance of each spot from the nearest wall."""
    starts, ends = _edges(corners)
    along = ends - starts
    share = np.einsum("npk,pk->np", spots[:, None] - starts, along) / (along**2).sum(axis=1)
    foot = starts + np.clip(share, 0, 1)[..., None] * along
    return np.asarray(np.linalg.norm(spots[:, None] - foot, axis=-1).min(axis=1))


def _inside(spots: NDArray[np.float64], corners: Corners) -> NDArray[np.bool_]:
    x, y = spots[:, :1], spots[:, 1:]
    (x0, y0), (x1, y1) = (points.T for points in _edges(corners))
    with np.errstate(divide="ignore", invalid="ignore"):
        crosses = ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return np.asarray(crosses.sum(axis=1) % 2 == 1)


def _crosses(spots: NDArray[np.float64], point: NDArray[np.float64], corners: Corners) -> NDArray[np.bool_]:
    """(N,) whether a wall stands between each spot and a point just before a wall."""
    starts, ends = _edges(corners)

    def turn(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(
            (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
        )

    here = spots[:, None]
    apart = turn(here, point, starts) * turn(here, point, ends) < 0
    apart &= turn(starts, ends, here) * turn(starts, ends, point) < 0
    return np.asarray(apart.any(axis=1))
