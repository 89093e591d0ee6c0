"""Openings of a wall: rectangles round the voxels that a beam looked through (section 5)."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from detector.parameters import DetectorParameters
from detector.rectangles import find_lines, pairs
from detector.result import Image, Mask, Openings, Orthoimage, Rectangle
from detector.room import VoxelLabel, Wall

LINE_WINDOW = 0.4
"""Shortest side of an opening that makes a line [m]: two voxels."""
LINE_SHARE = 0.5
MAX_LINES = 40
AT_FLOOR = 0.15
"""A rectangle whose lower side is this close to the floor stands on it [m]: less than a voxel."""


class Trinary(IntEnum):
    """Labels of the trinary image."""

    NO_DATA = 0
    DATA = 1
    CENTROID = 2


class Visibility(IntEnum):
    """What the beams say about a pixel of the wall."""

    UNKNOWN = 0
    """Never met."""
    DATA = 1
    """Holds a point of the wall's slab."""
    THROUGH = 2
    """Holds no point, and a beam went through."""
    SHADOWED = 3
    """Holds no point, and something stands before it."""


def visibility(merged: Orthoimage, passed: Mask, blocked: Mask, wall: Wall) -> Image:
    """(H, W) `Visibility` of each pixel.

    Voxels are too coarse for the outline of a hole; the beams themselves are not. Only where no beam came back at all,
    because there is nothing behind the hole, do the voxels decide.

    Args:
        passed: (H, W) where beams crossed the wall's face.
        blocked: (H, W) where beams were stopped well before the wall.
    """
    opening = voxel_mask(wall, VoxelLabel.OPENING, passed.shape, merged.pixel_size)
    data = np.isfinite(merged.depth)
    result = np.full(passed.shape, Visibility.UNKNOWN, np.uint8)
    result[blocked] = Visibility.SHADOWED
    result[opening & ~blocked] = Visibility.THROUGH
    result[passed] = Visibility.THROUGH
    result[data] = Visibility.DATA
    return result


def voxel_index(wall: Wall, shape: tuple[int, int], pixel_size: float) -> tuple[NDArray, NDArray]:
    """Row of the wall's voxels for each image row (H,), and column for each image column (W,)."""
    per_voxel = pixel_size / wall.voxel_size
    rows = ((np.arange(shape[0]) + 0.5) * per_voxel).astype(int)
    columns = ((np.arange(shape[1]) + 0.5) * per_voxel).astype(int)
    return np.minimum(rows, wall.voxel_labels.shape[0] - 1), np.minimum(columns, wall.voxel_labels.shape[1] - 1)


def voxel_mask(wall: Wall, label: VoxelLabel, shape: tuple[int, int], pixel_size: float) -> Mask:
    """(H, W) True in the voxels of a label."""
    rows, columns = voxel_index(wall, shape, pixel_size)
    return (wall.voxel_labels == label)[np.ix_(rows, columns)]


def find_openings(
    merged: Orthoimage, seen: Image, wall: Wall, floor: float, parameters: DetectorParameters
) -> Openings:
    """Best rectangle round each cluster of Opening voxels, by the five steps of section 5.

    Args:
        seen: (H, W) `Visibility`.
        floor: Height of the floor along v [m].
    """
    trinary = trinary_image(merged, wall)
    data = trinary == Trinary.DATA
    px = merged.pixel_size
    window = max(2, round(LINE_WINDOW / px))
    vertical = find_lines(_changes(data, 1), 0, window, LINE_SHARE, MAX_LINES)
    horizontal = find_lines(_changes(data, 0), 1, window, LINE_SHARE, MAX_LINES)
    clusters = cluster_centroids(wall.voxel_labels == VoxelLabel.OPENING)
    rows, columns = _with_borders(horizontal, data.shape[0]), _with_borders(vertical, data.shape[1])
    rectangles = tuple(
        best_rectangle(clusters == number, wall, rows, columns, px) for number in range(1, clusters.max(initial=0) + 1)
    )
    return Openings(
        trinary=trinary,
        horizontal_lines=np.rint(horizontal).astype(np.int32),
        vertical_lines=np.rint(vertical).astype(np.int32),
        clusters=clusters,
        rectangles=rectangles,
        is_door=tuple(r.bottom - floor < AT_FLOOR for r in rectangles),
        visibility=seen,
    )


def trinary_image(merged: Orthoimage, wall: Wall) -> Image:
    """Trinary image I: data, no data, and the centre pixel of each Opening voxel.

    The text of section 5 takes "data" from Occupied voxels, figure 7 from 3D points; the points outline the opening
    to a pixel, so they decide here, as far as they lie within the wall's layer of voxels.
    """
    in_voxel = np.abs(merged.depth) <= wall.voxel_size / 2  # False for NaN
    trinary = np.where(in_voxel, Trinary.DATA, Trinary.NO_DATA).astype(np.uint8)
    rows, columns = np.nonzero(wall.voxel_labels == VoxelLabel.OPENING)
    per_voxel = wall.voxel_size / merged.pixel_size
    rows, columns = ((rows + 0.5) * per_voxel).astype(int), ((columns + 0.5) * per_voxel).astype(int)
    inside = (rows < trinary.shape[0]) & (columns < trinary.shape[1])
    trinary[rows[inside], columns[inside]] = Trinary.CENTROID
    return trinary


def cluster_centroids(opening: Mask) -> NDArray[np.int32]:
    """Number of the cluster of each Opening voxel, 0 for the rest: regions grown over the eight neighbours."""
    from scipy.ndimage import label

    return label(opening, np.ones((3, 3)))[0].astype(np.int32)


def best_rectangle(cluster: Mask, wall: Wall, rows: NDArray, columns: NDArray, pixel_size: float) -> Rectangle:
    """Smallest rectangle between the lines that holds the most centroids of a cluster.

    Args:
        cluster: (rows, columns) of the wall's voxels, True in the cluster.
        rows, columns: Positions of the lines [px], ascending; whole numbers are pixel centres.
    """
    centres_v, centres_u = ((index + 0.5) * wall.voxel_size / pixel_size - 0.5 for index in np.nonzero(cluster))
    vertical, horizontal = pairs(columns, 1, np.inf), pairs(rows, 1, np.inf)
    held_u = _between(centres_u, columns[vertical])
    held_v = _between(centres_v, rows[horizontal])
    counts = held_v.astype(np.float32) @ held_u.T.astype(np.float32)
    areas = np.diff(rows[horizontal]) @ np.diff(columns[vertical]).T
    best = np.lexsort((areas.ravel(), -counts.ravel()))[0]
    (top, bottom), (left, right) = rows[horizontal[best // len(vertical)]], columns[vertical[best % len(vertical)]]
    left, right, top, bottom = ((x + 0.5) * pixel_size for x in (left, right, top, bottom))
    return Rectangle(left, max(0.0, wall.height - bottom), right, wall.height - top)


def _between(centres: NDArray, intervals: NDArray) -> NDArray[np.bool_]:
    """(P, N) True where a centre lies within an interval (P, 2)."""
    return (centres[None] > intervals[:, :1]) & (centres[None] < intervals[:, 1:])


def _with_borders(lines: NDArray, extent: int) -> NDArray:
    """The lines and the two borders of the image."""
    inner = lines[(lines > 1) & (lines < extent - 2)]
    return np.concatenate([[-0.5], inner, [extent - 0.5]])


def _changes(data: Mask, axis: int) -> Mask:
    """(H, W) True on the data side of each change between data and no data along an axis."""
    changes = np.zeros_like(data)
    ahead, behind = (np.s_[:, 1:], np.s_[:, :-1]) if axis == 1 else (np.s_[1:], np.s_[:-1])
    changes[ahead] |= data[ahead] & ~data[behind]
    changes[behind] |= data[behind] & ~data[ahead]
    return changes
