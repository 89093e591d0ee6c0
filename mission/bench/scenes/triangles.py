"""Polygons cut into triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Triangle = tuple[int, int, int]


def triangulated(corners: NDArray[np.float64]) -> list[Triangle]:
    """Cut a polygon (P, 2) without holes into P - 2 triangles, anticlockwise, by cutting off ears."""
    left = list(range(len(corners)))
    x, y = corners.T
    if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0:
        left.reverse()
    found: list[Triangle] = []
    while len(left) > 3:
        for k in range(len(left)):
            ear = left[k - 1], left[k], left[(k + 1) % len(left)]
            if _is_ear(corners, ear, left):
                found.append(ear)
                left.remove(ear[1])
                break
        else:
            raise ValueError("the polygon crosses itself")
    return [*found, (left[0], left[1], left[2])]


def _is_ear(corners: NDArray[np.float64], ear: Triangle, others: list[int]) -> bool:
    a, b, c = (corners[k] for k in ear)
    if _turn(a, b, c) <= 1e-12:
        return False
    inside = (
        min(_turn(a, b, corners[k]), _turn(b, c, corners[k]), _turn(c, a, corners[k])) > -1e-12
        for k in others
        if k not in ear
    )
    return not any(inside)


def _turn(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
