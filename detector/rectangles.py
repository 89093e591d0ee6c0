"""Lateral histograms, the straight lines in them, and the rectangles between the lines (sections 5 and 6.2)."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.result import Mask

TOLERANCE_PX = 1
"""A line may wander this far to either side."""
SEPARATION_PX = 3
"""Lines closer than this are one."""
LEAST_VISIBLE = 0.12
"""Less than this share of a line or a side says nothing, however clear it is: 0.2 m of a side of 1.6 m."""
CLEAR_SHARE = 0.8
"""Share of its visible part that a line or a side is an edge over at least, where furniture hides the rest."""


def lateral_histogram(edges: Mask, axis: int, window_px: int) -> NDArray[np.float32]:
    """Share of edge pixels along each column (axis 0) or row (axis 1), in the best window.

    A histogram over the whole wall drowns the top of one door in the texture of the rest; the window is as long as the
    shortest side of a door, and slides along the line.

    Returns:
        (W,) or (H,) shares in [0, 1].
    """
    window = min(window_px, edges.shape[axis])
    return _shares(_window_sums(edges, axis, window).max(axis=axis), window)


def _window_sums(mask: Mask, axis: int, window: int) -> NDArray[np.int32]:
    """Pixels of a mask in each window along the columns (axis 0) or rows (axis 1) that fits into the image.

    Returns:
        (H - window + 1, W) or (H, W - window + 1).
    """
    sums = integral(mask)
    ends, starts = (sums[window:], sums[:-window]) if axis == 0 else (sums[:, window:], sums[:, :-window])
    return np.diff(ends - starts, axis=1 - axis)


def _shares(sums: NDArray[np.int32], window: int) -> NDArray[np.float32]:
    """Sums over windows as parts of their length."""
    return (sums * (1 / window)).astype(np.float32)


def find_lines(
    edges: Mask, axis: int, window_px: int, share: float, limit: int = 40, visible: Mask | None = None
) -> NDArray[np.float64]:
    """Positions of the vertical (axis 0) or horizontal (axis 1) lines, as peaks of the lateral histogram.

    Args:
        share: Least share of the window that a line covers.
        limit: Most lines that are returned, the strongest ones.
        visible: Pixels that nothing hides; all where not given. A line may also be hidden in part if it is clear where
            it is seen.

    Returns:
        (L,) columns or rows, ascending; whole numbers are pixel centres.
    """
    across = (2 * TOLERANCE_PX + 1, 1) if axis == 0 else (1, 2 * TOLERANCE_PX + 1)
    wide = cv2.dilate(edges.view(np.uint8), np.ones(across[::-1], np.uint8)) > 0
    covered, sharp = lateral_histogram(wide, axis, window_px), lateral_histogram(edges, axis, window_px)
    is_line = covered >= share
    if visible is not None and not visible.all():
        is_line |= _clear_where_visible(wide, visible, axis, window_px)
    strength = np.convolve(sharp, [0.5, 1.0, 0.5])[1:-1]
    taken = np.zeros(len(sharp), bool)
    lines: list[float] = []
    for peak in np.argsort(-strength, kind="stable"):
        if len(lines) == limit:
            break
        if not is_line[peak] or taken[peak] or strength[peak] == 0:
            continue
        taken[max(0, peak - SEPARATION_PX + 1) : peak + SEPARATION_PX] = True
        low = max(0, peak - TOLERANCE_PX)
        weights = sharp[low : peak + TOLERANCE_PX + 1]
        lines.append(float((np.arange(low, low + len(weights)) * weights).sum() / weights.sum()))
    return np.sort(np.array(lines, np.float64))


def _clear_where_visible(edges: Mask, visible: Mask, axis: int, window_px: int) -> NDArray[np.bool_]:
    """(W,) or (H,) columns or rows with a window that is hidden in part, and edge over most of what is visible."""
    window = min(window_px, edges.shape[axis])
    result: Mask = np.asarray(~visible.all(axis=axis))
    lines = np.flatnonzero(result)
    seen, hits = (_window_sums(mask.take(lines, 1 - axis), axis, window) for mask in (visible, edges & visible))
    clear = _shares(hits, window) >= CLEAR_SHARE * np.maximum(_shares(seen, window), LEAST_VISIBLE)
    result[lines] = ((seen < window) & clear).any(axis=axis)
    return result


def pairs(lines: NDArray[np.float64], shortest: float, longest: float) -> NDArray[np.int64]:
    """(P, 2) indices of the pairs of ascending lines whose distance lies in the range."""
    i, j = np.triu_indices(len(lines), 1)
    distance = lines[j] - lines[i]
    return np.stack([i, j], axis=1)[(distance >= shortest) & (distance <= longest)]


def integral(mask: NDArray) -> NDArray[np.int32]:
    """(H + 1, W + 1) sums over all pixels above and to the left."""
    return np.asarray(cv2.integral(mask.astype(np.uint8)), np.int32)


def box_sums(sums: NDArray[np.int32], boxes: NDArray[np.int64]) -> NDArray[np.int32]:
    """(N,) sums over boxes (N, 4) of top, left, bottom, right, half open, clipped to the image."""
    top, bottom = (np.clip(boxes[:, i], 0, sums.shape[0] - 1) for i in (0, 2))
    left, right = (np.clip(boxes[:, i], 0, sums.shape[1] - 1) for i in (1, 3))
    return sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
