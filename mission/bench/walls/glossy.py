"""Highlights that the detector found, against those that the camera knows of (section 7.4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from detector.orthoimage import crop, orthoimage, sampling_gap
from detector.parameters import DetectorParameters
from detector.result import Mask, WallResult
from detector.room import Room

SMALLEST = 8e-4
"""Highlights below this are not asked for [m2]; the paper's smallest, section 7.4."""
FOUND_SHARE = 0.5
"""A highlight is found if this share of it lies in what the detector marked."""
FALSE_SHARE = 0.1
"""A marked region is false if less than this of it is gloss: the paper's splines reach out to the foot of a lobe."""


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
    result: WallResult, room: Room, glossy: tuple[Mask, ...], parameters: DetectorParameters
) -> HighlightCount:
    """Compare the highlight regions of each view of a wall with the gloss in that view's photographs.

    Gloss on what stands out further than a frame, such as handles and furniture, may be marked, but is not asked for.

    Args:
        result: What the detector found.
        room: What it was given.
        glossy: (N,) for each view of the room, where a point's colour holds gloss.
        parameters: That the detector ran with.
    """
    total = NONE
    wall = result.wall
    floor = float(np.clip(room.floor_height - wall.origin[2], 0, wall.height))
    for number, found in zip(result.view_numbers, result.highlights, strict=True):
        view = room.views[number]
        masked = replace(view, colours=np.repeat(np.uint8(255) * glossy[number][:, None], 3, axis=1))
        points = crop(masked, wall, floor, parameters)  # the gloss takes the way of the colour to the wall's image
        assert points is not None
        truth = orthoimage(points, wall, sampling_gap(points, parameters), parameters)
        gloss = truth.colour[..., 0] > 127
        asked = gloss & ~(truth.depth > parameters.slab_face)
        total += compare(asked, gloss, found.regions, pixel_size=parameters.pixel_size)
    return total


def compare(asked: Mask, gloss: Mask, marked: Mask, *, pixel_size: float) -> HighlightCount:
    """Count connected regions that meet the other.

    Args:
        asked: (H, W) gloss that is to be found.
        gloss: (H, W) all gloss, which may be marked.
        marked: (H, W) what the detector marked.
        pixel_size: [m].
    """
    least = SMALLEST / pixel_size**2
    covered = _shares(asked, marked, least)
    glossy = _shares(marked, gloss, least)
    return HighlightCount(
        true=len(covered),
        found=int(np.count_nonzero(covered >= FOUND_SHARE)),
        marked=len(glossy),
        false=int(np.count_nonzero(glossy < FALSE_SHARE)),
    )


def _shares(mask: Mask, other: Mask, least: float) -> np.ndarray:
    """(K,) share of each connected region of a mask, from `least` pixels on, that is in the other one."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    common = np.bincount(labels[other].ravel(), minlength=count)
    areas = stats[:, cv2.CC_STAT_AREA]
    large = np.flatnonzero((areas >= least) & (np.arange(count) > 0))
    return common[large] / areas[large]
