"""Where a depth picture jumps from one surface to another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_JUMP = 1e-3
"""Smallest step that counts, relative to the depth: 3 mm at 3 m, the noise of the scanner."""
_BAND = 64
"""Rows worked on at a time, so that they stay in the processor's cache."""


def blocks_across_jumps(raw: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Mark the 2 x 2 blocks of pixels that two surfaces share.

    Raw depth is linear over a plane, however oblique, and its steps change slowly over a curved surface. A step that
    leaves the interval of the steps before and after it is a jump; a crease, where two surfaces touch, is none.

    Args:
        raw: (H, W) raw depth, `Depth.raw`.

    Returns:
        (H, W) True where the block of pixels [i, i + 1] x [j, j + 1] holds a jump; False round the margin of two
        pixels.
    """
    height, width = raw.shape
    marks = np.zeros((height, width), bool)
    for start in range(1, height - 2, _BAND):
        stop = min(start + _BAND, height - 2)
        rows = raw[start - 1 : stop + 2]
        right = np.diff(rows[1:-1], axis=1)
        up = np.diff(rows, axis=0)
        tolerance = rows[1:-1] * np.float32(_JUMP)
        across = _leaves(right[:, 1:-1], right[:, :-2], right[:, 2:], tolerance[:, 1:-2])
        upward = _leaves(up[1:-1], up[:-2], up[2:], tolerance[:-1])
        marks[start:stop, 1:-2] = across[:-1] | across[1:] | upward[:, 1:-2] | upward[:, 2:-1]
    return marks


def _leaves(
    step: NDArray[np.float32],
    before: NDArray[np.float32],
    after: NDArray[np.float32],
    tolerance: NDArray[np.float32],
) -> NDArray[np.bool_]:
    """True where a step lies outside the interval of its neighbours."""
    high, low = np.maximum(before, after), np.minimum(before, after)
    high += tolerance
    low -= tolerance
    return (step > high) | (step < low)
