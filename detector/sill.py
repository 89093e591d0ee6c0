"""Whether a panel reaches the floor or hangs on the wall a hand above it (ours; for condition 2 of section 6.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.candidates import Boxes, Scene
from detector.steps import SAME_COLOUR, SAME_DEPTH, median_colour

SILL = 0.045
"""Height of the strip just above the floor [m]."""
BESIDE = 0.1
"""Width of the strips beside the rectangle [m]."""
PANEL = (0.3, 1.0)
"""What hangs is looked at between these heights above the floor [m]."""
DIFFERENT = 2.0
"""A panel that is less different from the sill, in units of what counts as the same, goes on down to the floor."""
LIKE_BESIDE = 0.35
"""The sill under a panel differs less than this from what is beside it, of how much it differs from the panel."""
LEAST_KNOWN = 0.2
"""Least share of a strip that must be seen."""


def hangs(box: Boxes, scene: Scene) -> bool:
    """Whether the wall goes on below one rectangle, as under a mirror or a whiteboard.

    Just above the floor such a rectangle holds what is beside it, and not what is higher up in it. A kick plate differs
    from both; a door of the wall's colour from neither.
    """
    columns = int(np.ceil(box.left[0] + 0.5)) + 1, int(np.floor(box.right[0] + 0.5)) - 1
    if columns not in scene.hanging:
        scene.hanging[columns] = _hangs(*columns, scene)
    return scene.hanging[columns]


def _hangs(left: int, right: int, scene: Scene) -> bool:
    """`hangs` for what is between two columns."""
    px = scene.merged.pixel_size
    sill = slice(max(scene.lowest_row - round(SILL / px), 0), scene.lowest_row)
    panel = slice(*(max(scene.floor_row - round(height / px), 0) for height in PANEL[::-1]))
    reach = round(BESIDE / px)
    within = _surface(scene, sill, slice(left, right))
    beside = [
        _surface(scene, sill, slice(max(a, 0), max(b, 0)))
        for a, b in ((left - reach, left - 2), (right + 2, right + reach))
    ]
    to_panel = _difference(within, _surface(scene, panel, slice(left, right)))
    to_wall = np.array([_difference(within, surface) for surface in beside])
    to_wall = to_wall[~np.isnan(to_wall)]
    return bool(to_panel > DIFFERENT and len(to_wall) and to_wall.max() < LIKE_BESIDE * to_panel)


def _surface(scene: Scene, rows: slice, columns: slice) -> NDArray[np.float64]:
    """(4,) median colour and depth of a strip in units of what counts as the same; NaN where it is hidden."""
    depth = scene.merged.depth[rows, columns]
    known = scene.merged.coloured[rows, columns] & scene.visible[rows, columns] & np.isfinite(depth)
    if known.sum() <= LEAST_KNOWN * known.size:
        return np.full(4, np.nan)
    colour = median_colour(scene.merged.colour[rows, columns], known)
    return np.append(colour / SAME_COLOUR, np.median(depth[known]) / SAME_DEPTH)


def _difference(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Largest difference of two surfaces; NaN where one is hidden."""
    return float(np.abs(a - b).max())
