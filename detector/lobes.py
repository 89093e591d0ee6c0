"""What of the gloss of a view is the mirror image of the flash (ours, on top of section 4.1).

A flat wall mirrors a flash beside the lens at the foot of the perpendicular from the camera, and a smooth surface
spreads it to a lobe round there: brightest in the middle, and soon over. A shadow in another view, or something that
stands out and is seen elsewhere from there, has no such shape.
"""

from __future__ import annotations

from dataclasses import dataclass
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
SHAPE = 0.25
"""Least share of the variance of a highlight that a lobe explains."""
CENTRE = 0.06
"""Largest incidence at the middle of a lobe, which lies halfway between the feet of lens and flash [rad]."""
AJAR = 0.12
"""The same on a door that is ajar, where a lobe must be large and clear [rad]."""
LARGE, CLEAR = 0.01, 0.8
"""A lobe of this area that explains more than this share is large and clear [m2, of 1]."""
TOP = 0.8, 0.5
"""More than the first of its height is reached by less than the second of a highlight: it is no plateau, unless by
overexposure."""
BRIDGE = np.ones((5, 5), np.uint8)
"""What an edge takes out of a highlight, in cells."""
SMALLEST = np.ones((3, 3), np.uint8)
"""The smallest highlight, in cells; what is narrower lies along an edge."""


@dataclass(frozen=True, eq=False)
class Gloss:
    """What a view shows brighter than others do, in coarse pixels."""

    levels: Floats
    """(h, w) of 255."""
    white: Mask
    """(h, w) where all channels are overexposed, so that there may be more of it."""
    untold: Mask
    """(h, w) where this view shows the wall, and no other can tell."""
    angle: Floats
    """(h, w) incidence [rad]."""
    foot: tuple[float, float]
    """Row and column of the foot of the perpendicular from the camera; may lie outside."""
    distance: float
    """Of the camera from the wall, in cells."""
    area: float
    """Of a cell [m2]."""


def lobes(gloss: Gloss, parameters: DetectorParameters) -> Mask:
    """(h, w) lobes of gloss, high and large enough, where a flat wall mirrors the flash.

    Something else may touch the foot of a lobe, and is left behind further up. The parts of a highlight on both sides
    of an edge make one lobe, or two of different height. It goes on where other views cannot tell.
    """
    found = np.zeros(gloss.levels.shape, bool)
    mirrors = gloss.angle < parameters.highlight_mirror_angle
    bridged = np.asarray(cv2.morphologyEx(gloss.levels, cv2.MORPH_CLOSE, BRIDGE), np.float32)
    for factor, levels in product(HEIGHTS, (bridged, gloss.levels)):
        height = 255 * parameters.min_gloss_contrast * factor
        if not ((levels > FOOT * height) & mirrors).any() or levels.max() < height:
            continue
        part = cv2.morphologyEx(((levels > FOOT * height) & ~found).view(np.uint8), cv2.MORPH_OPEN, SMALLEST)
        count, labels = cv2.connectedComponents(part, connectivity=8)
        rows, columns = np.nonzero(part)
        inside, shown = labels[rows, columns].astype(np.intp), levels[rows, columns]
        size = np.bincount(inside, minlength=count)
        peak = np.zeros(count, np.float32)
        np.maximum.at(peak, inside, shown)
        top = (shown > TOP[0] * peak[inside]) & ~gloss.white[rows, columns]
        kept = (size * gloss.area >= parameters.min_highlight_area) & (peak >= height)
        kept &= np.bincount(inside, top, count) < TOP[1] * size
        kept &= np.bincount(inside, mirrors[rows, columns], count) > 0
        for number in np.flatnonzero(kept):
            one = inside == number
            lobe = _fitted(rows[one], columns[one], shown[one], gloss)
            kept[number] = lobe is not None
            if lobe is not None:
                more = np.nonzero(gloss.untold)
                found[more] |= _terms(more[0], more[1], gloss) @ lobe > np.log(FOOT * height)
        found[rows, columns] |= kept[inside]
    return cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_CLOSE, BRIDGE) > 0


def _fitted(
    rows: NDArray[np.intp], columns: NDArray[np.intp], levels: Floats, gloss: Gloss
) -> NDArray[np.float64] | None:
    """(4,) coefficients of the `_terms` of the gloss of a region; None if that is no lobe round the foot of the
    perpendicular, or a part of one.

    A lobe cos^n over the angle is exp(-n angle^2 / 2), and the angle is the way over the distance: the logarithm of the
    levels is a paraboloid, wherever the region was cut out of it.

    Args:
        rows: (N,) of its cells.
        columns: (N,) likewise.
        levels: (N,) of gloss, above 0.
    """
    terms, logarithms = _terms(rows, columns, gloss), np.log(levels.astype(np.float64))
    lobe = np.asarray(np.linalg.lstsq(terms, logarithms, rcond=None)[0], np.float64)
    freedom = max(len(levels) - len(lobe), 1) / max(len(levels) - 1, 1)
    explained = 1 - (logarithms - terms @ lobe).var() / max(logarithms.var() * freedom, 1e-9)
    exponent = -2 * float(lobe[3])
    off_centre = np.hypot(lobe[1], lobe[2]) / max(exponent, 1e-9)
    obvious = explained > CLEAR and len(levels) * gloss.area > LARGE
    return lobe if exponent > SHEEN and explained > SHAPE and off_centre < (AJAR if obvious else CENTRE) else None


def _terms(rows: NDArray[np.intp], columns: NDArray[np.intp], gloss: Gloss) -> NDArray[np.float64]:
    """(N, 4) of a paraboloid over the angles from the foot: 1, x, y, x^2 + y^2 [rad]."""
    x, y = (columns - gloss.foot[1]) / gloss.distance, (rows - gloss.foot[0]) / gloss.distance
    return np.column_stack([np.ones_like(x), x, y, x * x + y * y])


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
