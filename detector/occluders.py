"""What stands before a wall and hides it: furniture, curtains, plants (figure 23; ours)."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.edges import FLAT, Edges
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Image, Mask, Orthoimage

NEARER = 0.1
"""What is nearer than this to the room and does not slope is no leaf [m]: one at 6 deg, 0.95 m wide, is nearer."""
SET_OFF, BORDER = 0.02, 0.015
"""Step to either side of what is set off, over this width [m]; a leaf leaves the wall's plane at its hinge by
degrees."""
LOOSE = 0.3
"""Least share of its height over which a leaf hangs on the wall, and of a shadow's rim that it borders on."""
LEAF_EDGE = 0.15
"""A leaf seen on its edge is a strip narrower than this, handles and slope included [m]."""
TALL = 0.3
"""What is lower than this hides no side of a door [m]."""
BESIDE = 0.01
"""A leaf lies this close to its hole, and to what it hides [m]."""
SHADOW = 0.03
"""Narrower shadows lie beside a leaf that is recessed, as the gap does [m]."""
SILHOUETTE = 0.015, 0.025
"""Edges this close to what stands just before the wall, and to a shadow, are their silhouette [m]."""


def occluders(merged: Orthoimage, seen: Image, edges: Edges, parameters: DetectorParameters) -> Mask:
    """(H, W) what hides the wall and stands just before it or throws a shadow on it, and its silhouette.

    A silhouette is no discontinuity of the wall. The leaf of an open door stands out, too, and throws a shadow, but it
    slopes, or is seen on its edge, a narrow strip beside its hole.
    """
    nearer = ((np.nan_to_num(merged.depth, nan=-np.inf) > NEARER) & ~edges.sloping).astype(np.uint8)
    across = np.ones((1, 2 * round(LEAF_EDGE / 2 / merged.pixel_size) + 1), np.uint8)
    narrow = (nearer > 0) & (cv2.morphologyEx(nearer, cv2.MORPH_OPEN, across) == 0)
    holes = seen == Visibility.THROUGH
    beside_hole = cv2.dilate(holes.astype(np.uint8), across) > 0
    nearer[narrow & beside_hole] = 0
    before = (nearer > 0) | _loose(merged, holes, max(parameters.max_protrusion, parameters.slab_face))
    behind = _shadows(seen, edges.sloping, holes, merged.pixel_size)
    return _grown(before, SILHOUETTE[0], merged.pixel_size) | _grown(behind, SILHOUETTE[1], merged.pixel_size)


def _grown(mask: Mask, way: float, pixel_size: float) -> Mask:
    side = 2 * round(way / pixel_size) + 1
    return cv2.dilate(mask.astype(np.uint8), np.ones((side, side), np.uint8)) > 0


def _loose(merged: Orthoimage, holes: Mask, protrusion: float) -> Mask:
    """(H, W) what stands before the wall without hanging on it by a side: curtains with their folds, for one.

    Args:
        protrusion: What stands out no further than this may be a leaf or a frame [m].
    """
    before = np.nan_to_num(merged.depth, nan=0.0) > protrusion
    if not before.any():
        return before
    count, labels, stats, _ = cv2.connectedComponentsWithStats(before.view(np.uint8), connectivity=4)
    height = stats[:, cv2.CC_STAT_HEIGHT]
    loose = height * merged.pixel_size > TALL
    loose[0] = False
    for side in (-1, 1):
        beyond = np.pad(before, ((0, 0), (1, 1)))[:, 1 + side : before.shape[1] + 1 + side]
        rows, columns = np.nonzero(before & ~beyond)
        smooth = _leaves_by_degrees(merged, rows, columns, side)
        loose &= np.bincount(labels[rows, columns], smooth, count) < LOOSE * height
    beside_hole = _grown(holes, BESIDE, merged.pixel_size)
    loose &= np.bincount(labels[before & beside_hole], minlength=count) < LOOSE * height
    for number in np.flatnonzero(loose).tolist():
        loose[number] = abs(_slope(merged, labels, number, stats[number])) < FLAT
    return np.asarray(loose[labels])


def _leaves_by_degrees(merged: Orthoimage, rows: NDArray, columns: NDArray, side: int) -> NDArray[np.bool_]:
    """(N,) whether the depth falls to the wall's without a step beside pixels of a border, right of them or left."""
    outer = np.clip(columns + side * max(1, round(BORDER / merged.pixel_size)), 0, merged.depth.shape[1] - 1)
    return np.asarray(merged.depth[rows, columns] - merged.depth[rows, outer] < SET_OFF)  # False for NaN


def _slope(merged: Orthoimage, labels: NDArray, number: int, box: NDArray) -> float:
    """Of the plane along u that fits a labelled part of the image best; 0 for a single column."""
    left, top, width, height = box[:4]
    part = np.s_[top : top + height, left : left + width]
    own = labels[part] == number
    u, depth = np.nonzero(own)[1] * merged.pixel_size, merged.depth[part][own].astype(np.float64)
    u -= u.mean()
    return float(u @ depth / (u @ u)) if width > 1 else 0.0


def _shadows(seen: Image, sloping: Mask, holes: Mask, pixel_size: float) -> Mask:
    """(H, W) what furniture further away hides; not what a leaf does, nor what lies beside a hole."""
    size = max(1, round(SHADOW / pixel_size))
    shadowed = cv2.morphologyEx((seen == Visibility.SHADOWED).astype(np.uint8), cv2.MORPH_OPEN, np.ones((size, size)))
    count, labels = cv2.connectedComponents(shadowed, connectivity=4)
    beside_leaf = _grown(holes | (sloping & (seen == Visibility.DATA)), BESIDE, pixel_size)
    rim = (shadowed > 0) & (cv2.erode(shadowed, np.ones((3, 3), np.uint8)) == 0)
    around, touching = (np.bincount(labels[mask], minlength=count) for mask in (rim, rim & beside_leaf))
    kept = touching < LOOSE * around
    kept[0] = False
    return np.asarray(kept[labels])
