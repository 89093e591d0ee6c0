"""Highlights that other views of the wall give away (ours, on top of section 4.1).

Paint stays where it is, and a highlight goes with the camera. Gloss adds the colour of the flash to every channel
(Shafer, "Using color to separate reflection components", 1985). So what one view shows brighter, in all channels, than
more oblique views do is gloss; `lobes.py` tells what of it is a highlight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.highlights import bounding_box, repaired
from detector.lobes import BRIDGE, SMALLEST, Floats, Gloss, lobes, outlines
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.result import Highlights, Image, Mask, Orthoimage

CELL = 0.01
"""Side of the pixels that views are compared in [m]: registered views agree to less, and no highlight is below 3."""
OBLIQUE = 1.2
"""Incidence beyond which a view is too dim to tell what is matt [rad]."""
NO_GLOSS = 0.25
"""Incidence beyond which a view hardly shows gloss [rad]."""
WHITE = 250
"""Level from which on a channel may be overexposed: it tells no more than that the wall is as bright at least."""
EDGE = 24
"""Difference within two cells from which on there is an edge, which registration may move [levels]."""
WHITISH = 0.25
"""Gloss brightens each channel by this part of the mean at least: a channel that is bright anyway shows less of it."""
NEARBY = 0.10
"""What stands out casts its shadow, and what slopes up to there is lit otherwise, within this [m]."""
HARDWARE = 0.04, 0.01
"""What is narrower than the first and stands out by more than the second, a handle, is seen elsewhere by others [m]."""
AROUND = 0.15
"""Half the side of the square that a view's brightness is compared in, over its distance from the wall."""
ENOUGH = 300
"""Cells that two views are compared on at least."""


@dataclass(frozen=True, eq=False)
class _Cells:
    """One view in coarse pixels."""

    shown: Image
    """(h, w, 3) as photographed."""
    colour: Image
    """(h, w, 3) in even light."""
    brightest: Image
    """(h, w, 3) likewise; at edges the brightest of a cell and its neighbours."""
    known: Mask
    """(h, w) where there is colour, and nothing that stands out from the wall."""
    telling: Mask
    """(h, w) where the view can tell what is matt: likewise, not overexposed, away from the border of what is known,
    where something may lie deeper, and not too oblique."""
    angle: Floats
    """(h, w) incidence [rad]."""
    foot: tuple[float, float]
    """Row and column of the foot of the perpendicular from the camera."""
    distance: float
    """Of the camera from the wall, in cells."""
    area: float
    """Of a cell [m2]."""


def compare_views(
    photographed: Sequence[Orthoimage],
    even: Sequence[Orthoimage],
    highlights: Sequence[Highlights],
    cameras: Sequence[NDArray[np.float64]],
    height: float,
    parameters: DetectorParameters,
) -> list[Highlights]:
    """The highlights of each view with those added that other views give away, and without those that others see, too.

    Args:
        photographed: Views of one wall.
        even: The same in even light.
        highlights: Of each view alone, found in even light.
        cameras: (3,) centre of each view's camera in wall coordinates [m].
        height: Height of the wall [m].
    """
    if len(even) < 2 or not parameters.correct_highlights:
        return list(highlights)
    cells = each(lambda view: _cells(*view, height, parameters), zip(photographed, even, cameras, strict=True))
    return each(lambda k: _settled(k, cells, even[k], highlights[k], parameters), range(len(even)))


def _settled(
    k: int, cells: Sequence[_Cells], image: Orthoimage, found: Highlights, parameters: DetectorParameters
) -> Highlights:
    """The highlights of view k; where others can tell, these decide."""
    own = cells[k]
    box = bounding_box(own.known & (own.angle < parameters.highlight_roi_angle))
    if own.known[box].size == 0:
        return found
    glossy, told = np.zeros(own.known.shape, np.float32), np.zeros(own.known.shape, np.uint8)
    levels, sees = _gloss(k, cells, box, parameters)
    told[box] = sees
    foot = own.foot[0] - box[0].start, own.foot[1] - box[1].start
    white, untold = own.shown[box].min(axis=2) >= WHITE, own.known[box] & ~sees
    untold &= own.angle[box] < parameters.highlight_roi_angle
    glossy[box] = lobes(Gloss(levels, white, untold, own.angle[box], foot, own.distance, own.area), parameters)
    size = found.regions.shape[1], found.regions.shape[0]
    regions = cv2.resize(glossy, size, interpolation=cv2.INTER_LINEAR) > 0.5
    contours = outlines(regions)
    if found.regions.any():
        alone = _unjudged(found.regions, cv2.resize(told, size, interpolation=cv2.INTER_NEAREST) > 0)
        contours += tuple(c for c in found.contours if _holds(alone, c.mean(axis=0)))
        regions |= alone
    regions &= image.coloured
    if not regions.any() and not found.regions.any():
        return found
    return replace(found, regions=regions, contours=contours, inpainted=repaired(image, regions))


def _unjudged(regions: Mask, told: Mask) -> Mask:
    """(H, W) those regions of which others do not see half."""
    count, labels = cv2.connectedComponents(regions.view(np.uint8), connectivity=8)
    areas, seen = (np.bincount(labels[mask], minlength=count) for mask in (regions, regions & told))
    return regions & (seen < 0.5 * areas)[labels]


def _holds(mask: Mask, point: NDArray[np.float64]) -> bool:
    """Whether a point (row, column) lies in the mask."""
    row, column = np.clip(np.rint(point).astype(int), 0, np.array(mask.shape) - 1)
    return bool(mask[row, column])


def _cells(
    photographed: Orthoimage,
    even: Orthoimage,
    camera: NDArray[np.float64],
    height: float,
    parameters: DetectorParameters,
) -> _Cells:
    shape = photographed.depth.shape
    shrink = max(1, round(CELL / even.pixel_size))
    size = -(-shape[1] // shrink), -(-shape[0] // shrink)
    side = shape[1] * even.pixel_size / size[0], shape[0] * even.pixel_size / size[1]
    u = (np.arange(size[0], dtype=np.float32) + np.float32(0.5)) * np.float32(side[0])
    v = height - (np.arange(size[1], dtype=np.float32) + np.float32(0.5)) * np.float32(side[1])
    off = np.hypot(u[None, :] - np.float32(camera[0]), v[:, None] - np.float32(camera[1]))
    angle = np.arctan2(off, np.float32(abs(camera[2])))
    colour, shown = (cv2.resize(i.colour, size, interpolation=cv2.INTER_AREA) for i in (even, photographed))
    whole = cv2.resize(photographed.coloured.view(np.uint8) * np.uint8(255), size, interpolation=cv2.INTER_AREA) == 255
    depth = np.asarray(cv2.resize(photographed.depth, size, interpolation=cv2.INTER_NEAREST), np.float32)
    known = cv2.medianBlur((whole & ~_stands_out(depth, side[0], parameters)).view(np.uint8), 3) > 0
    brightest, darkest = cv2.dilate(colour, BRIDGE), cv2.erode(colour, BRIDGE)
    reach = np.ones((1 + 2 * round(NEARBY / side[0]),) * 2, np.uint8)
    furniture = cv2.morphologyEx((depth > parameters.slab_face).view(np.uint8), cv2.MORPH_OPEN, SMALLEST)
    inner = (cv2.erode(known.view(np.uint8), SMALLEST) > 0) & (cv2.dilate(furniture, reach) == 0)
    return _Cells(
        shown=np.asarray(shown, np.uint8),
        colour=np.asarray(colour, np.uint8),
        brightest=np.where(cv2.subtract(brightest, darkest) > EDGE, brightest, colour),
        known=known,
        telling=inner & (_largest(np.asarray(shown)) < WHITE) & (angle < OBLIQUE),
        angle=angle,
        foot=((height - float(camera[1])) / side[1] - 0.5, float(camera[0]) / side[0] - 0.5),
        distance=abs(float(camera[2])) / side[0],
        area=side[0] * side[1],
    )


def _stands_out(depth: Floats, side: float, parameters: DetectorParameters) -> Mask:
    """(h, w) where there is a handle, furniture or the like."""
    millimetres = np.clip(np.nan_to_num(1e3 * depth) + 128, 0, 255).astype(np.uint8)
    around = cv2.medianBlur(millimetres, 1 + 2 * round(HARDWARE[0] / side))  # not moved by what is narrower than half
    handles = cv2.subtract(cv2.medianBlur(millimetres, 3), around) > 1e3 * HARDWARE[1]
    return handles | (depth > parameters.slab_face)


def _largest(colour: NDArray) -> NDArray:
    """(h, w) of the channels."""
    red, green, blue = cv2.split(colour)
    return np.asarray(cv2.max(cv2.max(red, green), blue))


def _mean(colour: NDArray) -> Floats:
    """(h, w) mean of the channels."""
    return np.asarray(cv2.transform(colour.astype(np.float32), np.full((1, 3), 1 / 3, np.float32)), np.float32)


def _gloss(
    k: int, cells: Sequence[_Cells], box: tuple[slice, slice], parameters: DetectorParameters
) -> tuple[Floats, Mask]:
    """Levels of its photograph that view k shows more than others do, and where any can tell, both in a box."""
    own, angle = cells[k], cells[k].angle[box]
    region = own.known[box] & (angle < parameters.highlight_roi_angle)
    bright = _mean(own.colour[box])
    matt, hint = np.zeros_like(own.colour[box]), np.zeros_like(own.colour[box])
    sure, told = np.zeros(region.shape, bool), np.zeros(region.shape, bool)
    for j, other in enumerate(cells):
        both = region & other.telling[box] & (other.angle[box] > angle)
        rim = np.flatnonzero(both & (angle > NO_GLOSS))
        rim = rim if len(rim) >= ENOUGH else np.flatnonzero(both)
        if j == k or len(rim) < ENOUGH:
            continue
        there = other.colour[box].reshape(-1, 3)[rim].mean(axis=1)
        ratio = float(np.median(bright.ravel()[rim] / np.maximum(there, 1)))
        predicted = cv2.convertScaleAbs(other.brightest[box], alpha=ratio)
        plain = both & (other.angle[box] > NO_GLOSS)
        # of several, the brightest: one that is too dark by mistake, in a shadow, makes no highlight
        for best, where in ((matt, plain), (hint, both)):
            cv2.max(best, cv2.bitwise_and(predicted, predicted, mask=where.view(np.uint8)), dst=best)
        sure |= plain
        told |= both
    matt = np.where(sure[..., None], matt, hint)  # a view with gloss of its own tells only where no other does
    more = np.asarray(cv2.subtract(own.colour[box], matt, dtype=cv2.CV_32F), np.float32)
    mean = _mean(more)
    dark = _too_dark(np.where(told, mean, np.float32(0)), own.distance)
    more[own.shown[box] >= WHITE] = np.inf
    mean -= dark
    white = told & (-_largest(-more) - dark > WHITISH * mean)
    levels = np.where(white, mean * _mean(own.shown[box]) / np.maximum(bright, 1), np.float32(0))
    return np.asarray(cv2.GaussianBlur(levels, (0, 0), 1.0), np.float32), told


def _too_dark(levels: Floats, distance: float) -> Floats:
    """(h, w) by how many levels, 0 or less, a view is darker round about than others make it.

    The median over twice the width of a highlight is not moved by it.
    """
    shrink = 4
    size = max(1, levels.shape[1] // shrink), max(1, levels.shape[0] // shrink)
    small = cv2.resize(levels, size, interpolation=cv2.INTER_NEAREST)
    side = 1 + 2 * max(1, round(AROUND * distance / shrink))
    around = cv2.medianBlur((np.clip(small, -60, 0) + 60.5).astype(np.uint8), side).astype(np.float32) - 60
    return np.asarray(cv2.resize(around, levels.shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)
