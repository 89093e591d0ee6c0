"""What is overhead besides a level ceiling: sloping roofs, lowered ceilings, bulkheads."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mission.by_columns import distinct

Floats = NDArray[np.float64]

_CELL = 0.1
"""Side of the cubes that tell which points hang together [m]."""
_REACH = 0.35
"""In plan: what is overhead of a place lies this near to it [m]."""
_FEWEST = 5


class Roof:
    """Surfaces that face downwards, each too large to be the underside of a lintel or of a shelf.

    Args:
        points: (N, 3) of all scans, evenly spread [m].
        normals: (N, 3) towards the scanners; NaN where the surface is not flat.
        lowest: World z below which nothing counts [m].
        least_area: Of a surface, in plan [m2].
    """

    def __init__(self, points: Floats, normals: Floats, *, lowest: float, least_area: float) -> None:
        from scipy.spatial import cKDTree

        overhead = points[(normals[:, 2] < -0.5) & (points[:, 2] > lowest)]
        self._points = overhead[_area_of_surface(overhead) >= least_area] if len(overhead) else overhead
        self._tree = cKDTree(self._points[:, :2])

    def height_over(self, places: Floats) -> Floats:
        """(M,) height of the lowest roof over places (M, 2) in plan; infinite where there is none [m]."""
        heights = np.full(len(places), np.inf)
        for k, near in enumerate(self._tree.query_ball_point(places, _REACH) if len(self._points) else ()):
            if len(near) >= _FEWEST:
                heights[k] = np.percentile(self._points[near, 2], 10)
        return heights


def _area_of_surface(points: Floats) -> Floats:
    """(N,) area in plan of what each point (N, 3) hangs together with [m2]."""
    from scipy.ndimage import label

    cell = np.floor(points / _CELL).astype(int)
    cell -= cell.min(axis=0)
    filled = np.zeros(cell.max(axis=0) + 1, bool)
    filled[tuple(cell.T)] = True
    surfaces, count = label(filled, np.ones((3, 3, 3)))
    number = surfaces[tuple(cell.T)]
    column = distinct(np.column_stack([number, cell[:, :2]]))
    area = np.bincount(column[:, 0], minlength=count + 1).astype(float) * _CELL**2
    return np.asarray(area[number], float)
