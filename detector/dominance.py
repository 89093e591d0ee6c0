"""Condition 1 of section 6.2: how much of a rectangle has one colour and lies on one plane."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.candidates import Boxes, Scene
from detector.openings import Visibility
from detector.orthoimage import column_medians
from detector.result import Image, Mask

SAMPLED_PX = 6
"""Every so many pixels are enough for the shares of a rectangle."""
BIN_OF_LEVEL = (np.arange(256) * 12 // 255).astype(np.uint8)
"""Bin of each level of a channel, of the thirteen in which the most frequent colour is sought."""
LIKE = 0.12 * 255
"""Colours closer than this in every channel are alike [levels]."""


@dataclass(frozen=True)
class Dominance:
    """Condition 1 on one rectangle."""

    colour_share: float
    """Visible share that has the dominant colour or is looked through: a semi-open door is a leaf and an opening."""
    depth_share: float
    """Visible share that lies on the dominant plane or is looked through."""
    depth: float
    """Depth of the dominant plane at that side of the rectangle where it is less [m]; NaN without data."""


def dominance(box: Boxes, scene: Scene) -> Dominance:
    """Dominant colour and depth of one rectangle; the depth may slope along u, as that of a semi-open leaf does."""
    cut = np.s_[
        int(np.ceil(box.top[0] + 0.5)) : scene.lowest_row : SAMPLED_PX,
        int(np.ceil(box.left[0] + 0.5)) : int(np.floor(box.right[0] + 0.5)) : SAMPLED_PX,
    ]
    seen = scene.seen[cut]
    data = (seen == Visibility.DATA) & scene.visible[cut]
    depth = np.where(data, scene.merged.depth[cut], np.float32(np.nan))
    through = float((seen == Visibility.THROUGH).sum())
    total = max(data.sum() + through, 1.0)
    if data.sum() < 10:
        return Dominance(through / total, through / total, float("nan"))
    plane = _plane(depth, data)
    on_plane = data & (np.abs(depth - plane[None, :]) < 0.02)
    coloured = data & scene.merged.coloured[cut]
    colour_share = float(data.sum())
    if coloured.any():
        colour_share *= _dominant_colour(scene.merged.colour[cut][coloured])
    depth_share = (through + float(on_plane.sum())) / total
    return Dominance((through + colour_share) / total, depth_share, float(min(plane[0], plane[-1])))


def _plane(depth: NDArray, data: Mask) -> NDArray[np.float64]:
    """(W,) depth of the dominant plane in each column: a robust line through the medians of the columns."""
    columns = np.flatnonzero(data.sum(axis=0) >= 0.2 * data.shape[0])
    if len(columns) < 5:
        return np.full(depth.shape[1], np.median(depth[data]), np.float64)
    medians = column_medians(depth[:, columns])
    i, j = np.triu_indices(len(columns), max(1, len(columns) // 6))
    slope = np.median((medians[j] - medians[i]) / (columns[j] - columns[i]))
    return np.arange(depth.shape[1]) * slope + np.median(medians - slope * columns)


def _dominant_colour(colours: Image) -> float:
    """Share of the colours (N, 3) that are like the most frequent one."""
    red, green, blue = (cv2.LUT(colours, BIN_OF_LEVEL).T).astype(np.int32)
    bins = (red * 13 + green) * 13 + blue
    pixels, like = colours[None], (bins == np.bincount(bins).argmax())[None].view(np.uint8)
    for _ in range(3):
        centre = np.array(cv2.mean(pixels, like)[:3])
        like = cv2.inRange(pixels, np.floor(centre - LIKE) + 1, np.ceil(centre + LIKE) - 1)
    return cv2.countNonZero(like) / len(colours)
