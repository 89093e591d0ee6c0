"""Discontinuities of colour and depth on a wall (section 6.2, figure 9)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from cv2.typing import MatLike
from numpy.typing import NDArray

from detector.openings import Visibility
from detector.orthoimage import nearest
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.result import Image, Mask, Orthoimage

DIFFERENCE = np.array([[-0.5, 0.0, 0.5]], np.float32)
"""Central difference along the columns; its transpose is that down the rows."""
ALONG = 0.075
"""Smoothing along a hypothetical side [m]: sides are upright or level (section 5), so it blurs noise, not edges."""
COLOUR_ALONG = 0.155
"""The same for colour, which is noisier against the steps that matter [m]."""
NOISE_FACTOR = 4.0
"""A gradient below this many times the wall's median is texture."""
FAINT_LEAST = 0.004
"""Least gradient of a faint edge per pixel, of 1: one grey value."""
FAINT_FACTOR = 5.0
"""A gradient this many times the wall's median is an edge, if a faint one."""
GRADIENT_STEPS = 1000
"""Grey values per unit of gradient for Otsu's histogram; stronger gradients than 0.255 count as that."""
SLOPE_REACH = 0.04
"""Half length over which a slope is measured [m]."""
SLOPE_NOISE = 8.0
"""How much less a step counts on a surface that slopes by one: the gaps between samples become steps there."""
FLAT = 0.1
"""Slope along u up to which a surface counts as parallel to the wall: 6 deg."""
SLOPE_OUTLIER = 4.5
"""Slopes up to this many times their median noise are none where that is more: three sigma."""


@dataclass(frozen=True, eq=False)
class Edges:
    """Discontinuities by kind and by direction, each (H, W)."""

    colour: Mask
    """J'_C."""
    depth: Mask
    """J'_D."""
    upright: Mask
    """Those of J'_CD that can lie on a vertical side."""
    level: Mask
    """Those that can lie on a horizontal side."""
    sloping: Mask
    """Where the surface turns away from the wall's plane, as a leaf that stands open does."""
    faint_upright: Mask
    """Like `upright`, with colour that changes by no more than clearly above its noise."""
    faint_level: Mask
    """Like `level`, likewise."""
    level_ends: Mask
    """Like `faint_level` from half the change on: what smoothing along an edge leaves of it at its end."""


def find_edges(merged: Orthoimage, seen: Image, parameters: DetectorParameters) -> Edges:
    """J'_C, J'_D, and their union by direction.

    Args:
        seen: (H, W) `Visibility`; the edge of a shadow is no edge of the wall.
    """
    parts: list[Callable[[], Any]] = [
        lambda: structure_tensor(*colour_derivatives(merged)),
        lambda: depth_edges(merged.depth, seen, merged.pixel_size, parameters),
    ]
    (e, f, g), relief = each(lambda part: part(), parts)
    gradient = np.where(merged.coloured, di_zenzo(e, f, g), np.float32(0))
    threshold = colour_threshold(gradient, merged.coloured, parameters)
    colour = gradient > threshold
    across = e >= g
    steps_across, steps_along = relief.edges & relief.across, relief.edges & ~relief.across
    faint_upright, _ = _faint(e, merged.coloured, threshold)
    faint_level, level_ends = _faint(g, merged.coloured, threshold)
    return Edges(
        colour=colour,
        depth=relief.edges,
        upright=(colour & across) | steps_across,
        level=(colour & ~across) | steps_along,
        sloping=relief.sloping,
        faint_upright=faint_upright | steps_across,
        faint_level=faint_level | steps_along,
        level_ends=level_ends | steps_along,
    )


def colour_derivatives(merged: Orthoimage) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(H, W, 3) change of the colour (0..1) per pixel along the columns and down the rows."""
    colour = nearest(merged.colour, merged.coloured).astype(np.float32) / np.float32(255)
    return _derivatives(colour, _odd(COLOUR_ALONG, merged.pixel_size))


def _odd(length: float, pixel_size: float) -> int:
    """An odd number of pixels about as long as a length [m]."""
    return 2 * round(length / pixel_size / 2) + 1


def _derivatives(image: NDArray[np.float32], along_px: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Central differences, each of the image smoothed along the other direction."""
    dx = _difference(cv2.blur(image, (1, along_px)), DIFFERENCE)
    dy = _difference(cv2.blur(image, (along_px, 1)), DIFFERENCE.T)
    return dx, dy


def _difference(image: MatLike, kernel: NDArray[np.float32]) -> NDArray[np.float32]:
    """An image filtered with one of the two central differences."""
    return np.asarray(cv2.filter2D(image, cv2.CV_32F, kernel, borderType=cv2.BORDER_REPLICATE), np.float32)


def structure_tensor(dx: NDArray[np.float32], dy: NDArray[np.float32]) -> tuple[NDArray[np.float32], ...]:
    """(H, W) each: sums over the channels of dx dx, dx dy and dy dy, from derivatives (H, W, 3)."""
    add = np.ones((1, 3), np.float32)
    e, f, g = (
        np.asarray(cv2.transform(cv2.multiply(a, b), add), np.float32) for a, b in ((dx, dx), (dx, dy), (dy, dy))
    )
    return e, f, g


def di_zenzo(e: NDArray[np.float32], f: NDArray[np.float32], g: NDArray[np.float32]) -> NDArray[np.float32]:
    """(H, W) largest rate of change of a vector image: root of the greater eigenvalue of its structure tensor [27]."""
    return np.sqrt((e + g + np.sqrt((e - g) ** 2 + 4 * f * f)) / 2)


def colour_threshold(gradient: NDArray[np.float32], coloured: Mask, parameters: DetectorParameters) -> float:
    """Otsu's threshold; capped, so that a strong poster does not hide a faint door, but never in the noise."""
    values = gradient[coloured]
    if len(values) == 0:
        return np.inf
    grey = np.minimum(values * GRADIENT_STEPS, 255).astype(np.uint8)
    otsu = cv2.threshold(grey[:, None], 0, 255, cv2.THRESH_OTSU)[0] / GRADIENT_STEPS
    if parameters.colour_threshold == "otsu":
        return float(otsu)
    return _above_noise(min(otsu, parameters.colour_edge_cap), NOISE_FACTOR, values)


def _faint(square: NDArray[np.float32], coloured: Mask, strong: float) -> tuple[Mask, Mask]:
    """(H, W) where the colour changes clearly above its noise in one direction: grain and boards have but one.

    Args:
        square: (H, W) squared rate of change in that direction.
        strong: Rate that is always an edge.

    Returns:
        Where it does, and where it changes by half as much.
    """
    if not coloured.any():
        return coloured, coloured
    rate = np.where(coloured, np.sqrt(square), np.float32(0))
    least = min(strong, _above_noise(FAINT_LEAST, FAINT_FACTOR, rate[coloured]))
    return rate > least, rate > least / 2


def _above_noise(least: float, factor: float, values: NDArray[np.float32]) -> float:
    """The larger of a value and the median of others times a factor; no median is sought where it is not needed."""
    if 2 * np.count_nonzero(values * np.float32(factor) >= least) < len(values):
        return float(least)
    return float(max(least, factor * float(np.median(values))))


@dataclass(frozen=True, eq=False)
class Relief:
    """What the depth shows, each (H, W)."""

    edges: Mask
    """J'_D."""
    across: Mask
    """True where the depth changes along the columns rather than down the rows."""
    sloping: Mask
    """True where the depth changes steadily along the columns."""


def depth_edges(depth: NDArray[np.float32], seen: Image, pixel_size: float, parameters: DetectorParameters) -> Relief:
    """Canny's edges of the depth, with the creases where a leaf leaves the wall's plane.

    Holes count as deep as the slab reaches; shadows and gaps take the depth of the nearest point, so that they have no
    edge of their own.
    """
    data, through = np.isfinite(depth), seen == Visibility.THROUGH
    known = np.where(through, np.float32(-parameters.slab_behind), depth)
    filled = nearest(known, data | through)
    if not (data | through).any():
        return Relief(*(np.zeros_like(data) for _ in range(3)))
    dx, dy = _derivatives(filled, _odd(ALONG, pixel_size))
    slope = _local_slope(dx[:: _slope_rows(pixel_size)], pixel_size, len(dx))
    # the face of a half-open leaf slopes, and has no edges; its noise grows with the slope times the sample spacing
    trust = np.float32(1) / (1 + np.float32(SLOPE_NOISE / pixel_size) * np.abs(slope))
    dx, dy = (dx - slope) * trust, dy * trust
    scale = 10_000.0  # derivatives in units of 0.1 mm, as 16-bit integers for Canny
    high = parameters.depth_edge / 2 * scale  # a central difference sees half a step
    whole_x, whole_y = (np.clip(np.rint(d * scale), -32000, 32000).astype(np.int16) for d in (dx, dy))
    steps = np.asarray(cv2.Canny(whole_x, whole_y, high / 2, high, L2gradient=True)) > 0
    sloping = np.abs(slope) > _flatness(slope, data, pixel_size)
    creases = _creases(sloping)
    near_data = cv2.dilate(data.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    across = np.where(steps, np.abs(dx) >= np.abs(dy), creases)
    return Relief((steps | creases) & near_data, across, sloping)


def wall_face(view: Orthoimage, parameters: DetectorParameters) -> Mask:
    """(H, W) where one view shows the wall's face, or what lies flat on it: near the plane and parallel to it.

    In the merged image the leaf of a wide open door hides wall that another view saw.
    """
    data = np.isfinite(view.depth)
    smooth = cv2.blur(nearest(view.depth, data), (1, _odd(ALONG, view.pixel_size)))
    slope = _local_slope(_difference(smooth[:: _slope_rows(view.pixel_size)], DIFFERENCE), view.pixel_size, len(smooth))
    near = np.abs(view.depth) < parameters.slab_face  # False for NaN
    return near & (np.abs(slope) <= _flatness(slope, near, view.pixel_size))


def _flatness(slope: NDArray[np.float32], wall: Mask, pixel_size: float) -> float:
    """Change per pixel up to which a surface is flat; a dark wall gives noisy ranges, and slopes that are no slopes.

    Noise changes down the rows, which the slope of a leaf does not.

    Args:
        wall: (H, W) pixels to measure the noise on.
    """
    apart = _odd(ALONG, pixel_size)  # rows that were not smoothed over the same pixels
    both = wall[apart:] & wall[:-apart]
    change = np.abs(slope[apart:] - slope[:-apart])[both]
    flat = FLAT * pixel_size
    return _above_noise(flat, SLOPE_OUTLIER / float(np.sqrt(2)), change) if len(change) else flat


def _slope_rows(pixel_size: float) -> int:
    """Every so many rows are enough for the slope: it is already smooth down the rows."""
    return _odd(ALONG, pixel_size) // 2 + 1


def _local_slope(dx: NDArray[np.float32], pixel_size: float, rows: int) -> NDArray[np.float32]:
    """(rows, W) steady part of the derivative along the columns: its running median, which no step moves.

    Args:
        dx: The derivative in every so many rows, by `_slope_rows`.
    """
    from scipy.ndimage import median_filter

    reach = _odd(2 * SLOPE_REACH, pixel_size) // 2
    ends = np.pad(dx, ((0, 0), (reach, reach)), mode="edge")
    one_line = median_filter(ends.ravel(), 2 * reach + 1)  # several times as fast as row by row
    coarse = one_line.reshape(ends.shape)[:, reach : reach + dx.shape[1]]
    return np.repeat(coarse, _slope_rows(pixel_size), axis=0)[:rows]


def _creases(sloping: Mask) -> Mask:
    """(H, W) both pixels of each upright border between flat and sloping: the hinge of a half-open leaf.

    The running median of the slope keeps such a border in place, and does not see steps.
    """
    changes = sloping[:, 1:] != sloping[:, :-1]
    creases = np.zeros_like(sloping)
    creases[:, 1:] |= changes
    creases[:, :-1] |= changes
    return creases
