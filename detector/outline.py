"""The doorway's sides to the pixel, once it is known what stands in it (ours)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage, Rectangle

REACH = 0.05
"""How far from the found line the edge of the hole is looked for [m]."""
ABSENT = 0.7
"""Share of a side's length over which the wall's face must be missing inside a hole."""


def settle_sides(
    rectangles: tuple[Rectangle, ...],
    merged: Orthoimage,
    passed: Mask,
    height: float,
    parameters: DetectorParameters,
) -> tuple[Rectangle, ...]:
    """Sides moved to the edge of the hole in the wall's face, where there is a hole.

    Door stops and the far edge of the reveal make lines within the doorway; a leaf that is open or deep in the reveal
    fills, once closed, the whole hole. A leaf flush with the wall has no hole, and keeps its own outline.

    Args:
        passed: (H, W) where beams crossed the wall's face.
    """
    return tuple(_settled(r, passed, height, merged.pixel_size) for r in rectangles)


def _settled(rectangle: Rectangle, passed: Mask, height: float, pixel_size: float) -> Rectangle:
    """One rectangle with its left, right and top side settled."""
    rows = np.s_[int((height - rectangle.top + 0.1) / pixel_size) : int((height - rectangle.bottom - 0.1) / pixel_size)]
    columns = np.s_[int((rectangle.left + 0.1) / pixel_size) : int((rectangle.right - 0.1) / pixel_size)]
    across, down = passed[rows].mean(axis=0), passed[:, columns].mean(axis=1)
    left = _edge(across, rectangle.left / pixel_size, 1, pixel_size)
    right = _edge(across, rectangle.right / pixel_size, -1, pixel_size)
    top = _edge(down, (height - rectangle.top) / pixel_size, 1, pixel_size)
    return Rectangle(left * pixel_size, rectangle.bottom, right * pixel_size, height - top * pixel_size)


def _edge(profile: NDArray, position: float, inward: int, pixel_size: float) -> float:
    """Border of the hole near a position, in pixel borders from the first pixel; the position if there is none.

    Args:
        profile: Share of each column or row that is looked through.
        inward: +1 where the doorway lies at higher indices, else -1.
    """
    reach = round(REACH / pixel_size)
    start = round(position)
    inside = np.arange(start + inward * reach, start - inward * (reach + 1), -inward) - (inward < 0)
    inside = inside[(inside >= 0) & (inside < len(profile))]
    values = profile[inside]
    hole = np.flatnonzero(values >= ABSENT)
    if len(hole) == 0:
        return position
    outermost = hole[-1]
    if outermost == len(values) - 1:  # goes on: not the edge of this hole
        return position
    pixel = int(inside[outermost])
    part = float(np.clip(values[outermost + 1], 0, 1))  # the pixel on the border is hole in part
    return pixel - part if inward > 0 else pixel + 1 + part
