"""Frames that stand out of their wall, and that an outline took in with the leaf (ours, for section 6.2).

A frame of the leaf's own colour shows no edge of colour between the two; seen from the far side, not even the gap. But
it stands out of the leaf by the same step, and is as wide, on both sides and above, and the leaf goes on to the floor.
A panel of the leaf does not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.orthoimage import column_medians
from detector.result import Orthoimage, Rectangle

NARROWEST, WIDEST = 0.02, 0.15
"""Of frames [m]."""
UNEVEN = 0.02
"""The two sides and the head of a frame are as wide but for this [m]."""
STEP = 0.005
"""Least step from a frame down to its leaf [m]; medians of hundreds of points are good to a tenth of it."""
FLAT = 0.002
"""Depths of one plane differ by less [m]."""
BLUR = 0.01
"""Next to an edge depths are a mixture of both its sides [m]."""
FOOT = 0.15
"""Above the floor, this much of the leaf must be as deep as its middle [m]; the bottom rail of a panel is higher."""


class _Strip(NamedTuple):
    """The part of a frame along one side."""

    width: float
    """[m]"""
    step: float
    """Down to the leaf [m]."""


def without_frame(rectangle: Rectangle, merged: Orthoimage, height: float) -> Rectangle:
    """The leaf's outline, where a closed door was found with its frame; else the rectangle itself.

    Args:
        rectangle: A closed door.
        height: Height of the wall [m].
    """
    px = merged.pixel_size
    left, right = (round(u / px) for u in (rectangle.left, rectangle.right))
    top, foot = (round((height - v) / px) for v in (rectangle.top, rectangle.bottom))
    depth, widest = merged.depth[top:foot, left:right], round(WIDEST / px)
    if min(depth.shape) <= 3 * widest:
        return rectangle
    leaf = depth[widest:, widest:-widest]
    low = leaf[-round(FOOT / px) : -round(BLUR / px)]
    level, foot_level = _median(leaf), _median(low)
    if not abs(level - foot_level) < FLAT:  # or nothing is seen of it
        return rectangle
    sides = [
        _strip(band, level, px)
        for band in (
            depth[widest:, : 2 * widest],
            depth[widest:, : -2 * widest : -1],
            depth[: 2 * widest, widest:-widest].T,
        )
    ]
    strips = [strip for strip in sides if strip is not None]
    if (
        len(strips) < len(sides)
        or _spread([s.width for s in strips]) > UNEVEN
        or _spread([s.step for s in strips]) > FLAT
    ):
        return rectangle
    west, east, head = (strip.width for strip in strips)
    return Rectangle(rectangle.left + west, rectangle.bottom, rectangle.right - east, rectangle.top - head)


def _strip(band: NDArray[np.float32], level: float, px: float) -> _Strip | None:
    """The strip of one depth that a band (M, N) begins with, if the leaf follows; columns go inwards from the side."""
    blur = round(BLUR / px)
    known = np.isfinite(band).any(axis=0)
    depths = np.full(band.shape[1], np.nan, np.float32)
    depths[known] = column_medians(band[:, known])
    face = _median(depths[blur : round(NARROWEST / px) + blur])
    if not face - level > STEP:
        return None
    ends = np.flatnonzero(depths[blur:] < (face + level) / 2)
    if len(ends) == 0:
        return None
    end = blur + int(ends[0])
    frame, beyond = depths[blur : end - blur], depths[end + blur : end + 4 * blur]
    is_frame = NARROWEST <= end * px <= WIDEST and len(frame) > 0 and np.nanmax(np.abs(frame - face)) < FLAT
    is_leaf = len(beyond) > 0 and np.nanmax(np.abs(beyond - level)) < FLAT
    return _Strip(end * px, face - level) if is_frame and is_leaf else None


def _median(values: NDArray[np.float32]) -> float:
    """Median of what is known; NaN if nothing is."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


def _spread(values: list[float]) -> float:
    return max(values) - min(values)
