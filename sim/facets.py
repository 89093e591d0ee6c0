"""Between the pixels of a depth picture: where two facets of a surface meet, or one surface ends before another."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.render import Depth

Floats = NDArray[np.floating]
"""float32 throughout."""

_BEND = 1e-4
"""Change of slope that counts, relative to the depth: interpolating across it is off by a quarter, 0.1 mm at 4 m."""
_FLAT = np.float32(3e-5)
"""Within this of a plane, relative to the depth, four pixels lie on one facet."""
_JUMP = np.float32(1e-3)
"""Within this a facet goes on to a third pixel, relative to the depth; a step of the scanner's noise at 3 m."""
_CHANGE = np.array([[1, -2, 1]], np.float32)
"""Of the slope at a pixel."""
_BAND, _CHUNK = 128, 2**14
"""Rows and blocks worked on at a time, so that they stay in the processor's cache."""


def bent_blocks(raw: Floats) -> NDArray[np.uint8]:
    """Mark the 2 x 2 blocks of pixels that are not part of one plane.

    Args:
        raw: (H, W) raw depth, `Depth.raw`: linear over a plane, however oblique.

    Returns:
        (H, W) 1 where the slope changes at a pixel of the block [i, i + 1] x [j, j + 1], else 0; without meaning
        round the margin of two pixels.
    """
    bent = np.empty(raw.shape, np.uint8)
    square = np.ones((2, 2), np.uint8)
    for start in range(0, len(raw), _BAND):
        rows = raw[max(start - 1, 0) : start + _BAND + 2]  # and those whose slopes and marks reach into the band
        tolerance = rows * np.float32(_BEND)
        along, upward = (cv2.filter2D(rows, -1, kernel) for kernel in (_CHANGE, _CHANGE.T))
        change = cv2.max(np.abs(along, out=along), np.abs(upward, out=upward))
        marks = cv2.dilate((change > tolerance).view(np.uint8), square, anchor=(0, 0))
        bent[start : start + _BAND] = marks[min(start, 1) :][:_BAND]
    return bent


def on_facets(depth: Depth, block: NDArray[np.int32], right: Floats, up: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Raw depth in bent blocks, from the facets that their corners lie on.

    A facet goes on straight. So the surface is the farthest of the facets' planes where it bulges towards us, the
    nearest where it is hollow. That this gives the depth at all four corners proves it, if they are of one geom; where
    it does not, a facet is narrower than three pixels, or a surface ends and the next one lies behind it.

    Args:
        depth: the picture.
        block: (N,) flat index of the lower left pixel of each block, two pixels within the picture.
        right: (N,) place in the block, 0 to 1 [px].
        up: (N,) likewise.

    Returns:
        (N,) raw depth; (N,) True where it is proven.
    """
    raw, proven = np.empty(len(block), np.float32), np.empty(len(block), bool)
    for start in range(0, len(block), _CHUNK):
        part = slice(start, start + _CHUNK)
        corners = _Corners(depth, block[part])
        raw[part], proven[part] = corners.surface(right[part], up[part]), corners.agree()
    return raw, proven


class _Corners:
    """The planes through the corners of blocks, each through the corner and the pixels beyond it."""

    right, up = (0, 1, 0, 1), (0, 0, 1, 1)
    """Of each corner in the block [px]."""

    def __init__(self, depth: Depth, block: NDArray[np.int32]) -> None:
        flat, segments, width = depth.raw.ravel(), depth.segments.ravel(), depth.raw.shape[1]
        self._one_geom = np.ones(len(block), bool)
        self._depth: list[Floats] = []
        self._slopes: list[tuple[Floats, Floats]] = []
        on_facet = []
        outward = np.zeros(len(block), np.float32)  # change of slope at the corners, seen from inside
        for right, up in zip(self.right, self.up, strict=True):
            corner = block + np.int32(right + up * width)
            aside, above = 2 * right - 1, 2 * up - 1  # away from the block
            here = flat.take(corner)
            self._one_geom &= segments.take(corner) == segments.take(block)
            beside, beyond = corner + aside, corner + above * width
            to_side, to_top = flat.take(beside) - here, flat.take(beyond) - here
            twist = flat.take(beyond + aside) - here - to_side - to_top
            bend = np.maximum(
                np.abs(flat.take(beside + aside) - here - to_side - to_side),
                np.abs(flat.take(beyond + above * width) - here - to_top - to_top),
            )
            on_facet.append((np.abs(twist) < _FLAT * here) & (bend < _JUMP * here))
            outward += to_side + to_top
            self._depth.append(here)
            self._slopes.append((to_side * np.float32(aside), to_top * np.float32(above)))
        self._bulge = np.where(outward < 0, np.float32(1), np.float32(-1))
        self._planes = [
            np.where(valid, here, np.inf * self._bulge) for valid, here in zip(on_facet, self._depth, strict=True)
        ]

    def surface(self, right: Floats | int, up: Floats | int) -> Floats:
        """(N,) depth that the facets lead to at a place in the block [px]; infinite where no corner is on one."""
        nearest = np.full(len(self._bulge), np.inf, np.float32)
        for k, (here, (to_right, upward)) in enumerate(zip(self._planes, self._slopes, strict=True)):
            plane = here + to_right * (right - self.right[k]) + upward * (up - self.up[k])
            plane *= self._bulge
            np.minimum(nearest, plane, out=nearest)
        nearest *= self._bulge
        return nearest

    def agree(self) -> NDArray[np.bool_]:
        """(N,) True where the facets are of one geom and lead to the depth at all four corners."""
        proven = self._one_geom.copy()
        for here, right, up in zip(self._depth, self.right, self.up, strict=True):
            proven &= np.abs(self.surface(right, up) - here) < _FLAT * here
        return proven
