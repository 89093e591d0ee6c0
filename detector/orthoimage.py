"""One 4D orthoimage of a wall for each scanning location (section 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.result import Image, Mask, Orthoimage
from detector.room import DetectorError, View, Wall

LEAF_REACH = 1.7
"""How far from the wall an open leaf can stand [m]."""
LOW = (-0.01, 0.1)
"""Heights over the floor of the points that show a leaf's lower edge [m]."""
MAX_PASSED = 1_500_000
"""Points behind the wall that are enough to outline its holes."""
BLOCK = 1 << 18
"""Points that are looked at at a time: their depths stay in the processor's cache."""


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
    low: NDArray[np.float32]
    """(F, 3) points of the slab at the floor and just above it."""
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
        None where the scanner or its camera stands behind the wall, or the view has no point in its slab.
    """
    scanner, camera = wall.wall_from_world(np.stack([view.scanner_in_world, view.camera_in_world]).astype(np.float64))
    if min(scanner[2], camera[2]) <= parameters.slab_front:
        return None
    points = view.points_in_world
    near, deep = _near_and_deep(points, wall, parameters)
    slab = _columns(wall.wall_from_world(points.take(near, axis=0)))
    low = np.flatnonzero((slab[1] > floor + LOW[0]) & (slab[1] < floor + LOW[1]) & _beside(slab[0], wall))
    inside = np.flatnonzero(_inside(slab[0], slab[1], wall) & (slab[1] >= floor + parameters.floor_margin))
    if len(inside) == 0:
        return None
    near = near.take(inside)
    behind = _columns(wall.wall_from_world(points.take(deep[:: 1 + len(deep) // MAX_PASSED], axis=0)))
    thinned = _columns(wall.wall_from_world(view.thinned_points))
    u, v, depths = thinned
    front = (depths > parameters.slab_front) & (depths < 0.98 * scanner[2])
    reach = (depths < LEAF_REACH) & (depths >= -parameters.face_tolerance)
    reach &= _beside(u, wall) & (v > floor + 0.1)
    beyond = (behind[2] > -LEAF_REACH) & (behind[1] > floor + 0.1)
    beyond &= _beside(behind[0], wall)
    return WallPoints(
        slab=slab.take(inside, axis=1).T,
        colours=view.colours.take(near, axis=0),
        coloured=view.coloured.take(near),
        passed=_crossings(behind, scanner, wall).T,
        blocked=_crossings(_chosen(thinned, front), scanner, wall).T,
        around=np.concatenate([_chosen(thinned, reach), _chosen(behind, beyond)], axis=1).T,
        low=slab.take(low, axis=1).T,
        scanner=scanner,
        camera=camera,
    )


def _near_and_deep(
    points: NDArray[np.float32], wall: Wall, parameters: DetectorParameters
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Indices of the points within the wall's slab, and of those behind its face."""

    def parts_of(start: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        depth = wall.depths(points[start : start + BLOCK])
        low = np.flatnonzero(depth < parameters.slab_front)
        depth = depth.take(low)
        index = (start + low).astype(np.int32)  # half the memory of numpy's own
        # minus infinity is no depth, and no number is none either: such points are left out
        behind = (depth < -parameters.face_tolerance) & (depth > -np.inf)
        return index[depth > -parameters.slab_behind], index[behind]

    blocks = each(parts_of, range(0, max(len(points), 1), BLOCK))
    near, behind = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    return near, behind


def _columns(points: NDArray[np.float32]) -> NDArray[np.float32]:
    """(3, N) u, v and depth of points (N, 3), each in one piece: several times as fast to compute with."""
    return np.ascontiguousarray(points.T)


def _chosen(columns: NDArray, chosen: NDArray[np.bool_]) -> NDArray:
    """`columns[:, chosen]`, which takes several times as long."""
    return columns.take(np.flatnonzero(chosen), axis=1)


def _inside(u: NDArray[np.float32], v: NDArray[np.float32], wall: Wall) -> NDArray[np.bool_]:
    """(N,) True over the wall's rectangle."""
    return (u >= 0) & (u < wall.width) & (v >= 0) & (v < wall.height)


def _beside(u: NDArray[np.float32], wall: Wall) -> NDArray[np.bool_]:
    """(N,) True over the wall's extent and as far beside it as an open leaf may reach."""
    return (u > -LEAF_REACH) & (u < wall.width + LEAF_REACH)


def _crossings(columns: NDArray[np.float32], scanner: NDArray[np.float64], wall: Wall) -> NDArray[np.float32]:
    """(2, K) where the beams to the points (3, N) meet the wall's plane, of those that meet its rectangle."""
    origin = scanner.astype(np.float32)
    along = origin[2] / (origin[2] - columns[2])
    u, v = (origin[i] + along * (columns[i] - origin[i]) for i in range(2))
    inside = np.flatnonzero(_inside(u, v, wall))
    return np.stack([u.take(inside), v.take(inside)])


def pixels(points: NDArray[np.float32], wall: Wall, shape: tuple[int, int], pixel_size: float) -> NDArray[np.int32]:
    """(N,) flat index of the pixel that holds each point of the wall's rectangle."""
    columns = (points[:, 0] / pixel_size).astype(np.int32)
    index = ((wall.height - points[:, 1]) / pixel_size).astype(np.int32)
    np.clip(index, 0, shape[0] - 1, out=index)
    index *= shape[1]
    index += np.minimum(columns, shape[1] - 1, out=columns)
    return index


def orthoimage(points: WallPoints, wall: Wall, gap_px: int, parameters: DetectorParameters) -> Orthoimage:
    """The 4D orthoimage J_CD^k of one view: mean colour and maximum depth of the points in each pixel.

    Gaps between the samples of the view are closed with the nearest pixel's values, as wide as the sampling asks for.

    Args:
        gap_px: Widest gap between neighbouring samples [px], from `sampling_gap`.
    """
    shape = image_shape(wall, parameters)
    index = pixels(points.slab, wall, shape, parameters.pixel_size)

    def depth_image() -> tuple[NDArray[np.float32], Mask]:
        depth = largest(index, points.slab[:, 2], shape[0] * shape[1]).reshape(shape)
        return depth, np.isfinite(depth)

    def colour_image() -> tuple[Image, Mask]:
        return _mean_colour(index, points, shape)

    def closed(image: Callable[[], tuple[NDArray, Mask]]) -> tuple[NDArray, Mask]:
        values, known = image()
        filled = close_gaps(known, gap_px)
        return nearest(values, known, filled), filled

    images: list[Callable[[], tuple[NDArray, Mask]]] = [depth_image, colour_image]
    (depth, _), (colour, coloured) = each(closed, images)
    return Orthoimage(colour, coloured, depth, parameters.pixel_size)


def _mean_colour(index: NDArray[np.int32], points: WallPoints, shape: tuple[int, int]) -> tuple[Image, Mask]:
    """(H, W, 3) mean colour of the coloured points in each pixel, black where there is none, and where there is one.

    Args:
        index: (M,) pixel of each point of the slab.
    """
    from scipy.sparse import csc_array

    count = len(index)
    # one column a point: the product adds red, green, blue and opacity of each point to its pixel in one pass
    pixel_of_point = csc_array(
        (points.coloured.astype(np.float32), index, np.arange(count + 1, dtype=np.int32)),
        (shape[0] * shape[1], count),
    )
    opaque = cv2.cvtColor(points.colours[None], cv2.COLOR_RGB2RGBA)[0].astype(np.float32)
    *sums, opacity = cv2.split((pixel_of_point @ opaque).reshape(*shape, 4))
    counts = np.maximum(opacity / 255, 1)
    mean = cv2.convertScaleAbs(cv2.merge([channel / counts for channel in sums]))
    return np.asarray(mean, np.uint8), opacity > 0


def largest(index: NDArray[np.integer], values: NDArray[np.float32], size: int) -> NDArray[np.float32]:
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
    columns, rows = ((points.slab[:, i] / block).astype(np.int32) for i in range(2))
    across = int(rows.max()) + 1
    columns *= across
    counts = np.bincount(columns + rows)
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


def nearest(image: NDArray, known: Mask, wanted: Mask | None = None) -> NDArray:
    """The image with unknown pixels replaced by the nearest known one; unchanged where none is known.

    Args:
        wanted: (H, W) pixels to replace where they are unknown; all if not given.
    """
    gaps = np.flatnonzero(~known if wanted is None else wanted & ~known)
    if len(gaps) == 0 or not known.any():
        return image
    _, labels = cv2.distanceTransformWithLabels((~known).view(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL)
    number = np.asarray(labels, np.int32).ravel().take(gaps) - 1  # known pixels are labelled from 1, row by row
    source = np.flatnonzero(known).take(number)
    result = image.copy()
    flat = result.reshape(known.size, -1)
    flat[gaps] = flat.take(source, axis=0)
    return result


def mark(crossings: NDArray[np.float32], wall: Wall, gap_px: int, parameters: DetectorParameters) -> Mask:
    """(H, W) True where crossings fell, with the gaps between samples closed."""
    shape = image_shape(wall, parameters)
    mask = np.zeros(shape[0] * shape[1], bool)
    mask[pixels(crossings, wall, shape, parameters.pixel_size)] = True
    return close_gaps(mask.reshape(shape), gap_px)


def column_medians(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """(W,) median of each column without its NaNs; every column has a number. Many times as fast as `np.nanmedian`."""
    ascending = np.sort(values, axis=0)  # NaNs go to the end
    count = len(values) - np.isnan(values).sum(axis=0)
    lower, upper = (np.take_along_axis(ascending, middle[None], axis=0)[0] for middle in ((count - 1) // 2, count // 2))
    return (lower + upper) / 2
