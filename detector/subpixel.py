"""The sides of a doorway to a fraction of a pixel, from the gradient across them (ours)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.parameters import DetectorParameters
from detector.result import Orthoimage

WINDOW = 0.02
"""Half width of the window that an edge's centre is taken over [m]: both flanks of the gap between leaf and frame."""
REACH = 0.03
"""An edge whose centre lies further from the found line is another one [m]."""
ITERATIONS = 8
SEEN = 0.2
"""Least share of a side that must be seen on both sides of it."""
FAINT = 0.004
"""Least step of an edge: one grey value, or 0.4 mm."""
STEP_LIMIT = 0.3
"""Differences count no more than this: one stray pixel does not outweigh a side."""


def components(merged: Orthoimage, parameters: DetectorParameters) -> NDArray[np.float32]:
    """(H, W, 4) colour of 0..1 and depth over `depth_scale`, NaN where unknown: what `edge_centre` works on."""
    depth = merged.depth / np.float32(parameters.depth_scale)
    values = np.dstack([merged.colour.astype(np.float32) / 255, depth])
    values[~merged.coloured, :3] = np.nan
    return values


def edge_centre(values: NDArray[np.float32], axis: int, position: float, pixel_size: float) -> float:
    """Centre of the gradient along an axis, near a position; the position itself if there is none.

    A step of colour or depth has one flank, the dark gap round a leaf has two, which differ by the light; samples that
    lie wider apart than pixels make a staircase of either. The centre of all flanks is the edge in each case.

    Args:
        values: (H, W, 4) colour and scaled depth; NaN where unknown.
        position: Where the line is, in borders of pixels.
    """
    window = WINDOW / pixel_size
    margin = REACH / pixel_size + 2 * window
    first = max(int(position - margin) - 1, 0)
    band = np.moveaxis(values, axis, 0)[first : int(position + margin) + 3]
    if len(band) < 2 or band.shape[1] == 0:
        return position
    gradient = _gradient(band, window)
    borders = first + 1 + np.arange(len(gradient))
    centre = position
    for _ in range(ITERATIONS):
        # a triangle, so that an edge does not jump in or out
        weights = gradient * np.clip(1 - np.abs(borders - centre) / window, 0, None)
        if weights.sum() < FAINT:
            return position
        centre = float((weights * borders).sum() / weights.sum())
    return centre if abs(centre - position) * pixel_size <= REACH else position


def _gradient(band: NDArray[np.float32], window: float) -> NDArray[np.float64]:
    """(N - 1,) size of the mean step between neighbouring lines (N, M, 4), less what is steady slope or noise."""
    from scipy.ndimage import median_filter

    steps = np.clip(np.diff(band, axis=0), -STEP_LIMIT, STEP_LIMIT)
    known = np.isfinite(steps)
    counts = known.sum(axis=1)
    mean = np.where(known, steps, 0).sum(axis=1, dtype=np.float64) / np.maximum(counts, 1)
    mean[counts < SEEN * band.shape[1]] = 0
    mean -= median_filter(mean, (2 * round(window) + 1, 1), mode="nearest")
    size = np.linalg.norm(mean, axis=1)
    return np.maximum(size - np.median(size), 0)
