"""View merging: one orthoimage of a wall from those of its views (section 4.2)."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.highlights import bounding_box
from detector.illumination import incidence
from detector.parallel import bands, each
from detector.parameters import DetectorParameters
from detector.result import Highlights, Image, Mask, Orthoimage

CONTOUR_FILTER = 5
"""Side of the mean filter over the contour of a highlight [px]; section 4.2 gives none."""
GLOSS = 0.03
"""Standard deviation of the brightness, of 1, that two views of matt paint differ by: 0.08 more is gloss."""
NO_GLOSS_ANGLE = 0.35
"""Incidence beyond which a view shows no gloss [rad]: a lobe of MuJoCo's default exponent, 64, has fallen to 2 %."""
CORE_ANGLE = 0.25
"""Incidence beyond which a view that is glossy, too, is still better than inpainting [rad]: 13 % of that lobe."""
OWN_PART = np.exp(-0.5 * (np.arange(256, dtype=np.float32) / 255 / GLOSS) ** 2)
"""How much a view keeps of its own colour, by how many levels it is brighter than the matt one."""
FEATHER = 0.03
"""Half the width of the border round a highlight over which its view comes in again [m]."""
ENOUGH = 500
"""Pixels that two views are compared on at least."""
SAMPLES = 20_000
"""Pixels that are enough to compare them on."""


def view_weights(angles: NDArray, specular: NDArray[np.bool_], parameters: DetectorParameters) -> NDArray[np.float32]:
    """w(theta) of equation 1: w1 favours frontal views, w2, on highlights, intermediate lateral ones.

    Args:
        angles: Incidence angles [rad], any shape.
        specular: True on a highlight of this view, same shape.
    """
    mean = np.where(specular, np.float32(parameters.w2_mean), np.float32(parameters.w1_mean))
    std = np.where(specular, np.float32(parameters.w2_std), np.float32(parameters.w1_std))
    return np.exp(-0.5 * ((angles - mean) / std) ** 2).astype(np.float32)


def matt_colours(
    images: Sequence[Orthoimage], highlights: Sequence[Highlights], angles: Sequence[NDArray[np.float32]]
) -> list[tuple[Image, Mask]]:
    """Colours of each view with its highlights replaced by what other views see there (ours).

    What the flash mirrors depends on the view, the colour of the wall does not (Shafer, "Using color to separate
    reflection components", 1985), and gloss adds to every channel. Within a view's region of interest, a pixel that is
    brighter in all channels than in a more oblique view, further out on its lobe, takes the colour of that one,
    brought to the brightness that this view has round its highlight. So no step appears where the replacement ends.
    A highlight itself is replaced as a whole: where it is overexposed, a channel may be too dark.

    Args:
        images: Views of even light, as they were before highlights were filled in.
        angles: (H, W) incidence of each view [rad].

    Returns:
        (H, W, 3) colour and (H, W) where it is only inpainted, for each view.
    """
    return each(lambda k: _matt(k, images, highlights, angles), range(len(images)))


def _matt(
    k: int, images: Sequence[Orthoimage], highlights: Sequence[Highlights], angles: Sequence[NDArray[np.float32]]
) -> tuple[Image, Mask]:
    """`matt_colours` of view k."""
    image, found = images[k], highlights[k]
    colour, guessed = found.inpainted.copy(), found.regions.copy()
    box = bounding_box(found.region_of_interest & image.coloured)
    own, matt, told = image.colour[box], np.zeros_like(image.colour[box]), np.zeros_like(guessed[box])
    for j, other in enumerate(images):
        sees = found.region_of_interest[box] & image.coloured[box] & other.coloured[box]
        sees &= angles[j][box] > angles[k][box]
        sees &= ~highlights[j].regions[box] | (angles[j][box] > CORE_ANGLE)
        rim = np.flatnonzero(sees & (angles[k][box] > NO_GLOSS_ANGLE) & ~found.regions[box])
        if j == k or len(rim) < ENOUGH:
            continue
        some = rim[:: 1 + len(rim) // SAMPLES]
        here, there = (c.reshape(-1, 3)[some].mean(axis=1) for c in (own, other.colour[box]))
        matched = cv2.convertScaleAbs(other.colour[box], alpha=float(np.median(here / np.maximum(there, 1))))
        # of several, the brightest: one that is too dark by mistake takes nothing out
        cv2.max(matt, cv2.bitwise_and(matched, matched, mask=sees.view(np.uint8)), dst=matt)
        told |= sees
    if not told.any():
        return colour, guessed
    red, green, blue = cv2.split(cv2.subtract(own, matt))  # not below 0
    gloss = np.minimum(np.minimum(red, green), blue)
    marked = _feathered(found.regions[box], image.pixel_size)
    changed = np.flatnonzero(told & ((gloss > 2) | (marked > 0)))
    own_part = (OWN_PART.take(gloss.ravel().take(changed)) * (1 - marked.ravel().take(changed)))[:, None]
    own, matt = (c.reshape(-1, 3).take(changed, axis=0) for c in (own, matt))
    view = colour[box]
    view[np.unravel_index(changed, told.shape)] = np.rint(own_part * own + (1 - own_part) * matt)
    guessed[box] &= ~told
    return colour, guessed


def _feathered(regions: Mask, pixel_size: float) -> NDArray[np.float32]:
    """(H, W) 1 in regions, and less and less round them until 0 at twice `FEATHER`."""
    side = 1 + 2 * round(FEATHER / pixel_size)
    wide = cv2.dilate(regions.view(np.uint8), np.ones((side, side), np.uint8))
    return np.asarray(cv2.blur(wide.astype(np.float32), (side, side)), np.float32)


def merge(
    images: Sequence[Orthoimage],
    highlights: Sequence[Highlights],
    cameras: Sequence[NDArray[np.float64]],
    height: float,
    parameters: DetectorParameters,
) -> Orthoimage:
    """The unified J_CD: depth is the maximum over the views, colour their weighted mean (equation 1).

    Args:
        cameras: (3,) centre of each view's camera in wall coordinates [m].
        height: Height of the wall [m].
    """
    angles = each(lambda view: incidence(*view, height)[0], zip(images, cameras, strict=True))
    colours = [(h.inpainted, h.regions) for h in highlights]
    if parameters.correct_highlights and len(images) > 1:
        colours = matt_colours(images, highlights, angles)
    parts = each(lambda rows: _unified(rows, images, angles, colours, parameters), bands(len(angles[0])))
    colour, coloured, depth = (np.concatenate(rows) for rows in zip(*parts, strict=True))
    contour = np.zeros(coloured.shape, bool)
    for _, guessed in colours:
        contour |= cv2.morphologyEx(guessed.view(np.uint8), cv2.MORPH_GRADIENT, np.ones((5, 5), np.uint8)) > 0
    contour &= coloured
    if contour.any():
        colour[contour] = cv2.blur(colour, (CONTOUR_FILTER, CONTOUR_FILTER))[contour]
    return Orthoimage(np.asarray(cv2.convertScaleAbs(colour), np.uint8), coloured, depth, images[0].pixel_size)


def _unified(
    rows: slice,
    images: Sequence[Orthoimage],
    angles: Sequence[NDArray[np.float32]],
    colours: Sequence[tuple[Image, Mask]],
    parameters: DetectorParameters,
) -> tuple[NDArray[np.float32], Mask, NDArray[np.float32]]:
    """Some rows of the unified colour, of where there is one, and of the depth."""
    shape = angles[0][rows].shape
    depth = np.full(shape, np.nan, np.float32)
    total, colour = np.zeros(shape, np.float32), np.zeros((*shape, 3), np.float32)
    for image, angle, (seen, guessed) in zip(images, angles, colours, strict=True):
        depth = np.fmax(depth, image.depth[rows])
        # the floor keeps a pixel that only oblique views saw, whose weight would vanish in 32 bits
        weight = np.maximum(view_weights(angle[rows], guessed[rows], parameters), 1e-12)
        weight[~image.coloured[rows]] = 0
        total += weight
        colour += cv2.multiply(seen[rows], cv2.merge([weight] * 3), dtype=cv2.CV_32F)
    coloured = total > 0
    mean = cv2.divide(colour, cv2.merge([np.where(coloured, total, np.float32(1))] * 3))
    return np.asarray(mean, np.float32), coloured, np.asarray(depth)
