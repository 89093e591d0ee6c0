"""One 4D orthoimage of a wall for each scanning location (section 4)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage
from detector.room import DetectorError, View, Wall

LEAF_REACH = 1.7
"""How far from the wall an open leaf can stand [m]."""
THINNED_TO = 600_000
"""Points of a view that are enough for shadows and leaves."""
MAX_PASSED = 1_500_000
"""Points behind the wall that are enough to outline its holes."""


@dataclass(frozen=True, eq=False)
class WallPoints:
    """What one view knows about one wall, in the wall's coordinates (along u, along v, depth into the room) [m]."""

    slab: NDArray[np.float32]
    """(M, 3) points within the wall's slab."""
    colours: NDArray[np.uint8]
    """(M, 3) sRGB of the slab's points."""
    coloured: NDArray[np.bool_]
    """(M,) True where the colour is known."""
    passed: NDArray[np.float32]
    """(K, 2) where beams that ended behind the wall's face crossed it, along u and v."""
    blocked: NDArray[np.float32]
    """(K, 2) where beams that ended well before the wall would have met it; thinned."""
    around: NDArray[np.float32]
    """(L, 3) points up to a leaf's width from the wall, on both sides; thinned before it."""
    scanner: NDArray[np.float64]
    """(3,) origin of the beams."""
    camera: NDArray[np.float64]
    """(3,) centre of the camera."""


def image_shape(wall: Wall, parameters: DetectorParameters) -> tuple[int, int]:
    """Rows and columns of a wall's images.

    Raises:
        DetectorError: The wall is empty or has more than `max_pixels` pixels.
    """
    for name, value in (("width", wall.width), ("height", wall.height)):
        if not (np.isfinite(value) and value > 0):
            raise DetectorError(f"Wall.{name}: expected a positive length, got {value}")
    rows, columns = (
        max(1, int(np.ceil(extent / parameters.pixel_size - 1e-9))) for extent in (wall.height, wall.width)
    )
    if rows * columns > parameters.max_pixels:
        raise DetectorError(
            f"pixel_size: {parameters.pixel_size} m makes {rows} x {columns} pixels of a wall of "
            f"{wall.width:.2f} x {wall.height:.2f} m; at most {parameters.max_pixels} are accepted (max_pixels)"
        )
    return rows, columns


def crop(view: View, wall: Wall, floor: float, parameters: DetectorParameters) -> WallPoints | None:
    """The points of a view that concern a wall.

    Args:
        floor: Height of the floor along v [m].

    Returns:
        None where the view stands behind the wall or has no point in its slab.
    """
    scanner, camera = wall.wall_from_world(np.stack([view.scanner_in_world, view.camera_in_world]).astype(np.float64))
    if not scanner[2] > parameters.slab_front:
        return None
    points = view.points_in_world
    depths = wall.depths(points)
    near = np.flatnonzero((depths > -parameters.slab_behind) & (depths < parameters.slab_front))
    slab = wall.wall_from_world(points.take(near, axis=0))
    inside = np.flatnonzero(_inside(slab[:, 0], slab[:, 1], wall) & (slab[:, 1] >= floor + parameters.floor_margin))
    if len(inside) == 0:
        return None
    near, slab = near.take(inside), slab.take(inside, axis=0)
    deep = np.flatnonzero(depths < -parameters.face_tolerance)
    behind = wall.wall_from_world(points.take(deep[:: 1 + len(deep) // MAX_PASSED], axis=0))
    thinned = wall.wall_from_world(points[:: 1 + 2 * (len(points) // (2 * THINNED_TO))])
    front = (thinned[:, 2] > parameters.slab_front) & (thinned[:, 2] < 0.98 * scanner[2])
    reach = (thinned[:, 2] < LEAF_REACH) & (thinned[:, 2] >= -parameters.face_tolerance)
    reach &= (thinned[:, 0] > -LEAF_REACH) & (thinned[:, 0] < wall.width + LEAF_REACH) & (thinned[:, 1] > floor + 0.1)
    beyond = (behind[:, 2] > -LEAF_REACH) & (behind[:, 1] > floor + 0.1)
    return WallPoints(
        slab=slab,
        colours=view.colours.take(near, axis=0),
        coloured=view.coloured.take(near),
        passed=_crossings(behind, scanner, wall),
        blocked=_crossings(_rows(thinned, front), scanner, wall),
        around=np.concatenate([_rows(thinned, reach), _rows(behind, beyond)]),
        scanner=scanner,
        camera=camera,
    )


def _rows(array: NDArray, chosen: NDArray[np.bool_]) -> NDArray:
    """(M, ...) the chosen rows of an array (N, ...): `array[chosen]`, which takes several times as long."""
    return array.take(np.flatnonzero(chosen), axis=0)


def _inside(u: NDArray[np.float32], v: NDArray[np.float32], wall: Wall) -> NDArray[np.bool_]:
    """(N,) True over the wall's rectangle."""
    return (u >= 0) & (u < wall.width) & (v >= 0) & (v < wall.height)


def _crossings(points: NDArray[np.float32], scanner: NDArray[np.float64], wall: Wall) -> NDArray[np.float32]:
    """(K, 2) where the beams to the points meet the wall's plane, of those that meet its rectangle."""
    origin = scanner.astype(np.float32)
    along = origin[2] / (origin[2] - points[:, 2])
    u, v = (origin[i] + along * (points[:, i] - origin[i]) for i in range(2))
    inside = np.flatnonzero(_inside(u, v, wall))
    return np.stack([u.take(inside), v.take(inside)], axis=1)


def pixels(points: NDArray[np.float32], wall: Wall, shape: tuple[int, int], pixel_size: float) -> NDArray[np.int64]:
    """(N,) flat index of the pixel that holds each point of the wall's rectangle."""
    columns = np.minimum((points[:, 0] / pixel_size).astype(np.int64), shape[1] - 1)
    rows = np.clip(((wall.height - points[:, 1]) / pixel_size).astype(np.int64), 0, shape[0] - 1)
    return rows * shape[1] + columns


def orthoimage(points: WallPoints, wall: Wall, gap_px: int, parameters: DetectorParameters) -> Orthoimage:
    """The 4D orthoimage J_CD^k of one view: mean colour and maximum depth of the points in each pixel.

    Gaps between the samples of the view are closed with the nearest pixel's values, as wide as the sampling asks for.

    Args:
        gap_px: Widest gap between neighbouring samples [px], from `sampling_gap`.
    """
    shape = image_shape(wall, parameters)
    index = pixels(points.slab, wall, shape, parameters.pixel_size)
    size = shape[0] * shape[1]
    depth = largest(index, points.slab[:, 2], size).reshape(shape)
    known = np.flatnonzero(points.coloured)
    index, colours = index.take(known), points.colours.take(known, axis=0)
    counts = np.bincount(index, minlength=size)
    sums = np.stack([np.bincount(index, colours[:, i], size) for i in range(3)], axis=1)
    colour = np.rint(sums / np.maximum(counts, 1)[:, None]).astype(np.uint8).reshape(*shape, 3)
    coloured = (counts > 0).reshape(shape)
    filled = close_gaps(np.isfinite(depth), gap_px)
    filled_colour = close_gaps(coloured, gap_px) & filled
    depth = np.where(filled, nearest(depth, np.isfinite(depth)), np.float32(np.nan))
    colour = np.where(filled_colour[..., None], nearest(colour, coloured), np.uint8(0))
    return Orthoimage(colour, filled_colour, depth, parameters.pixel_size)


def largest(index: NDArray[np.int64], values: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """(size,) largest value of each index; NaN where there is none."""
    result = np.full(size, -np.inf)
    np.maximum.at(result, index, values.astype(np.float64))  # ten times as fast as in 32 bits (numpy 2.4)
    return np.where(np.isfinite(result), result, np.nan).astype(np.float32)


def sampling_gap(points: WallPoints, parameters: DetectorParameters) -> int:
    """Widest gap between neighbouring samples on the wall [px], from the density of the points themselves.

    The angular step is the root of the solid angle per point, taken over blocks of 8 x 8 pixels; on the wall it grows
    with the square of the range over the distance from the wall.
    """
    block = 8 * parameters.pixel_size
    columns, rows = ((points.slab[:, i] / block).astype(np.int64) for i in range(2))
    across = int(rows.max()) + 1
    counts = np.bincount(columns * across + rows)
    keys = np.flatnonzero(counts)
    counts = counts[keys]
    centres = (np.stack([keys // across, keys % across], axis=1) + 0.5) * block
    distance = points.scanner[2]
    ranges = np.sqrt(((centres - points.scanner[:2]) ** 2).sum(axis=1) + distance**2)
    step = np.sqrt(np.median(block**2 * distance / ranges**3 / counts))
    spacing = np.quantile(step * ranges**2 / distance, 0.8)
    return int(np.clip(np.ceil(1.5 * spacing / parameters.pixel_size), 1, parameters.max_gap_px))


def close_gaps(mask: Mask, gap_px: int) -> Mask:
    """The mask with gaps up to `gap_px` pixels closed; straight borders stay where they are."""
    kernel = np.ones((gap_px + 1 + gap_px % 2,) * 2, np.uint8)
    padded = cv2.copyMakeBorder(mask.astype(np.uint8), *(gap_px + 1,) * 4, cv2.BORDER_CONSTANT, value=0)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel)
    return closed[gap_px + 1 : -gap_px - 1, gap_px + 1 : -gap_px - 1] > 0


def nearest(image: NDArray, known: Mask) -> NDArray:
    """The image with every unknown pixel replaced by the nearest known one; unchanged where none is known."""
    if known.all() or not known.any():
        return image
    _, labels = cv2.distanceTransformWithLabels(
        (~known).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    here, gaps = np.flatnonzero(known), np.flatnonzero(~known)
    label = np.asarray(labels, np.int64).ravel()
    source = np.zeros(len(here) + 1, np.int64)
    source[label.take(here)] = here
    result = image.copy()
    flat = result.reshape(known.size, -1)
    flat[gaps] = flat.take(source.take(label.take(gaps)), axis=0)
    return result


def mark(crossings: NDArray[np.float32], wall: Wall, gap_px: int, parameters: DetectorParameters) -> Mask:
    """(H, W) True where crossings fell, with the gaps between samples closed."""
    shape = image_shape(wall, parameters)
    mask = np.zeros(shape[0] * shape[1], bool)
    mask[pixels(crossings, wall, shape, parameters.pixel_size)] = True
    return close_gaps(mask.reshape(shape), gap_px)
