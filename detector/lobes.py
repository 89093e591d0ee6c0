"""What of the gloss of a view is the mirror image of the flash (ours, on top of section 4.1).

A flat wall mirrors a flash beside the lens at the foot of the perpendicular from the camera, and a smooth surface
spreads it to a lobe round there: brightest in the middle, and soon over. A shadow in another view, or something that
stands out and is seen elsewhere from there, has no such shape.
"""

from __future__ import annotations

from itertools import product

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.highlights import DIRECTIONS
from detector.parameters import DetectorParameters
from detector.result import Mask

Floats = NDArray[np.float32]

FOOT = 0.4
"""Where a highlight ends, in parts of its height."""
HEIGHTS = 1.0, 2.0, 4.0
"""Least heights of highlights that are looked for one after the other, in parts of the least contrast."""
SHEEN = 10.0
"""Exponent of a lobe that is at half its height 20 deg from its middle. A wider one is the sheen of matt paint."""
SHAPE = 0.5
"""Least correlation of a highlight with a lobe."""
TOP = 0.8, 0.5
"""More than the first of its height is reached by less than the second of a highlight: it is no plateau."""
BRIDGE = np.ones((5, 5), np.uint8)
"""What an edge takes out of a highlight, in cells."""
SMALLEST = np.ones((3, 3), np.uint8)
"""The smallest highlight, in cells; what is narrower lies along an edge."""


def lobes(levels: Floats, angle: Floats, distance: float, area: float, parameters: DetectorParameters) -> Mask:
    """(h, w) lobes of gloss, high and large enough, where a flat wall mirrors the flash.

    Something else may touch the foot of a lobe, and is left behind further up. The parts of a highlight on both sides
    of an edge make one lobe, or two of different height.

    Args:
        levels: (h, w) of gloss, of 255.
        angle: (h, w) incidence [rad].
        distance: Of the camera from the wall, in cells.
        area: Of a cell [m2].
    """
    found = np.zeros(levels.shape, bool)
    mirrors = angle < parameters.highlight_mirror_angle
    bridged = np.asarray(cv2.morphologyEx(levels, cv2.MORPH_CLOSE, BRIDGE), np.float32)
    for factor, gloss in product(HEIGHTS, (bridged, levels)):
        height = 255 * parameters.min_gloss_contrast * factor
        if not ((gloss > FOOT * height) & mirrors).any() or gloss.max() < height:
            continue
        part = cv2.morphologyEx(((gloss > FOOT * height) & ~found).view(np.uint8), cv2.MORPH_OPEN, SMALLEST)
        count, labels = cv2.connectedComponents(part, connectivity=8)
        rows, columns = np.nonzero(part)
        inside, shown = labels[rows, columns].astype(np.intp), gloss[rows, columns]
        fall, agreement = _fall(rows, columns, shown.astype(np.float64), inside, count)
        # a lobe cos^n over the angle is exp(-n angle^2 / 2), and the angle is the way over the distance
        kept = (agreement > SHAPE) & (2 * fall * distance**2 > SHEEN)
        size = np.bincount(inside, minlength=count)
        kept &= size * area >= parameters.min_highlight_area
        peak = np.zeros(count, np.float32)
        np.maximum.at(peak, inside, shown)
        kept &= (peak >= height) & (np.bincount(inside, shown > TOP[0] * peak[inside], count) < TOP[1] * size)
        kept &= np.bincount(inside, mirrors[rows, columns], count) > 0
        found[rows, columns] |= kept[inside]
    return cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_CLOSE, BRIDGE) > 0


def _fall(
    rows: NDArray[np.intp], columns: NDArray[np.intp], levels: NDArray[np.float64], labels: NDArray, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How the gloss of each region falls off from its middle, exp(-fall r^2) [1/cells^2], and how well (correlation).

    Args:
        rows: (N,) of the cells of all regions.
        columns: (N,) likewise.
        levels: (N,) of gloss, above 0.
        labels: (N,) number of the region, below `count`.
    """

    def total(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.bincount(labels, values, count).astype(np.float64)

    size, weight = np.maximum(np.bincount(labels, minlength=count), 1), np.maximum(total(levels**2), 1e-9)
    row, column = ((total(levels**2 * axis) / weight)[labels] for axis in (rows, columns))
    squares = (rows - row) ** 2 + (columns - column) ** 2
    x, y = (values - (total(values) / size)[labels] for values in (squares, -np.log(levels)))
    common, spread = total(x * y), np.maximum(total(x * x), 1e-9)
    return common / spread, common / np.sqrt(spread * np.maximum(total(y * y), 1e-9))


def outlines(regions: Mask) -> tuple[NDArray[np.float64], ...]:
    """For each region the (8, 2) last of its pixels from its centroid in each direction, as (row, column)."""
    count, labels, stats, centroids = cv2.connectedComponentsWithStats(regions.view(np.uint8), connectivity=8)
    found = []
    for number in range(1, count):
        centre = centroids[number, ::-1]
        steps = np.arange(1 + int(np.hypot(stats[number, cv2.CC_STAT_WIDTH], stats[number, cv2.CC_STAT_HEIGHT])))
        paths = np.rint(centre + steps[:, None, None] * DIRECTIONS).astype(int)
        within = ((paths >= 0) & (paths < regions.shape)).all(axis=2)
        paths = np.clip(paths, 0, np.array(regions.shape) - 1)
        within &= labels[paths[..., 0], paths[..., 1]] == number
        last = np.where(within, steps[:, None], 0).max(axis=0)
        found.append(centre + last[:, None] * DIRECTIONS)
    return tuple(found)
