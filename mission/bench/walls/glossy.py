"""Highlights that the detector found, against those that the camera knows of (section 7.4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.orthoimage import crop, nearest, orthoimage, sampling_gap
from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage, WallResult
from detector.room import Room

SHOWS = 13
"""Levels of 255 that a highlight brightens the picture by: 5 %, as much as a plain wall varies by itself (section
7.2.2)."""
TRACE = 3
"""Levels of 255 that are still gloss, on the skirt of a highlight, and may be marked."""
SMALLEST = 8e-4
"""Highlights below this are not asked for [m2]; the paper's smallest, section 7.4."""
JOINED = 0.1
"""Pieces of a highlight that are no further apart are one: the gap round a door cuts it, a frame that the flash makes
white anyway, or coarse sampling [m]."""
CUT = 0.03
"""The same for what the detector marked: the gap round a door [m]."""
FOUND_SHARE = 0.5
"""A highlight is found if this share of it lies in what the detector marked."""
FALSE_SHARE = 0.1
"""A marked region is false if less than this of it is gloss: the paper's splines reach out to the foot of a lobe."""
STANDING_OUT = 0.045
"""What stands out further than frames and skirting is furniture [m]."""
HARDWARE = 0.042, 0.004
"""What is narrower than the first and stands out by more than the second is a handle or a hinge, not wall [m]."""
HANDLE = 0.02, 0.06
"""What stands out by the first, narrow as it is, is a handle, and gloss that lies within the second of one for the more
part is its plate [m]."""
NARROW = 0.032
"""What is narrower than the smallest highlight, as a disc, is a glint on an edge or a strip of metal, such as the frame
of a picture or the plate of a handle [m]."""


@dataclass(frozen=True)
class HighlightCount:
    """How many highlights there are, in all views of a wall or of several."""

    true: int = 0
    """Larger than `SMALLEST`."""
    found: int = 0
    marked: int = 0
    """Regions that the detector marked, larger than `SMALLEST`."""
    false: int = 0

    def __add__(self, other: HighlightCount) -> HighlightCount:
        return HighlightCount(
            self.true + other.true, self.found + other.found, self.marked + other.marked, self.false + other.false
        )


NONE = HighlightCount()


def count_highlights(
    result: WallResult, room: Room, gloss: tuple[NDArray[np.uint8], ...], parameters: DetectorParameters
) -> HighlightCount:
    """Compare the highlight regions of each view of a wall with the gloss in that view's photographs.

    A highlight is a connected piece of wall, door or anything flat on them, larger than `SMALLEST`, that the mirror
    image of the flash brightens by `SHOWS` at least. Gloss on what stands out, such as handles and furniture, may be
    marked, but is not asked for.

    Args:
        result: What the detector found.
        room: What it was given.
        gloss: (N,) for each view of the room, levels that gloss brightens each point by.
        parameters: That the detector ran with.
    """
    total = NONE
    wall = result.wall
    floor = float(np.clip(room.floor_height - wall.origin[2], 0, wall.height))
    for number, found in zip(result.view_numbers, result.highlights, strict=True):
        told = replace(room.views[number], colours=np.repeat(gloss[number][:, None], 3, axis=1))
        points = crop(told, wall, floor, parameters)  # the gloss takes the way of the colour to the wall's image
        assert points is not None
        truth = orthoimage(points, wall, sampling_gap(points, parameters), parameters)
        levels = truth.colour[..., 0]
        total += compare(highlights_in(levels, truth), levels >= TRACE, found.regions, pixel_size=parameters.pixel_size)
    return total


def highlights_in(levels: NDArray[np.uint8], image: Orthoimage) -> Mask:
    """(H, W) highlights on the wall or on what lies flat on it or is recessed, by the levels that gloss adds (H, W)."""
    known = np.isfinite(image.depth)
    depth = cv2.blur(cv2.medianBlur(nearest(image.depth, known), 5), (5, 5))  # the largest of noisy depths is rough
    millimetres = np.clip(128 + 1e3 * depth, 0, 255).astype(np.uint8)
    # the median over twice its width is not moved by something narrow
    around = (cv2.medianBlur(millimetres, _odd(2 * HARDWARE[0] / image.pixel_size)).astype(np.float32) - 128) / 1e3
    hardware = depth - around > HARDWARE[1]
    flat = known & (depth <= STANDING_OUT) & ~hardware
    shows = cv2.morphologyEx((flat & (levels >= SHOWS)).view(np.uint8), cv2.MORPH_OPEN, _disc(NARROW, image.pixel_size))
    count, labels = cv2.connectedComponents(shows, connectivity=8)
    near = cv2.dilate((known & (depth - around > HANDLE[0])).view(np.uint8), _disc(2 * HANDLE[1], image.pixel_size)) > 0
    areas, beside = (np.bincount(labels[mask], minlength=count) for mask in (shows > 0, (shows > 0) & near))
    return (shows > 0) & (beside <= 0.5 * areas)[labels]


def _disc(diameter: float, pixel_size: float) -> NDArray[np.uint8]:
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (_odd(diameter / pixel_size),) * 2), np.uint8)


def _odd(pixels: float) -> int:
    """The next odd number."""
    return 1 + 2 * round(max(pixels - 1, 0) / 2)


def compare(asked: Mask, gloss: Mask, marked: Mask, *, pixel_size: float) -> HighlightCount:
    """Count connected regions that meet the other.

    Args:
        asked: (H, W) gloss that is to be found.
        gloss: (H, W) all gloss, which may be marked.
        marked: (H, W) what the detector marked.
        pixel_size: [m].
    """
    covered = _shares(asked, marked, pixel_size, JOINED)
    glossy = _shares(marked, gloss, pixel_size, CUT)
    return HighlightCount(
        true=len(covered),
        found=int(np.count_nonzero(covered >= FOUND_SHARE)),
        marked=len(glossy),
        false=int(np.count_nonzero(glossy < FALSE_SHARE)),
    )


def _shares(mask: Mask, other: Mask, pixel_size: float, gap: float) -> NDArray[np.float64]:
    """(K,) share in the other mask of each region of a mask that is larger than `SMALLEST`, gaps [m] closed."""
    disc = _disc(gap, pixel_size)
    margin = disc.shape[0]
    padded = cv2.copyMakeBorder(mask.astype(np.uint8), *(margin,) * 4, cv2.BORDER_CONSTANT, value=0)
    joined = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disc)[margin:-margin, margin:-margin]
    count, labels = cv2.connectedComponents(joined, connectivity=8)
    areas = np.bincount(labels[mask], minlength=count)
    common = np.bincount(labels[mask & other], minlength=count)
    large = np.flatnonzero(areas * pixel_size**2 > SMALLEST)
    return common[large] / areas[large]
