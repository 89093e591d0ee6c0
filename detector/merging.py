"""View merging: one orthoimage of a wall from those of its views (section 4.2)."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.illumination import incidence
from detector.parameters import DetectorParameters
from detector.result import Highlights, Orthoimage

CONTOUR_FILTER = 5
"""Side of the mean filter over the contour of a highlight [px]; section 4.2 gives none."""


def view_weights(angles: NDArray, specular: NDArray[np.bool_], parameters: DetectorParameters) -> NDArray[np.float32]:
    """w(theta) of equation 1: w1 favours frontal views, w2, on highlights, intermediate lateral ones.

    Args:
        angles: Incidence angles [rad], any shape.
        specular: True on a highlight of this view, same shape.
    """
    mean = np.where(specular, np.float32(parameters.w2_mean), np.float32(parameters.w1_mean))
    std = np.where(specular, np.float32(parameters.w2_std), np.float32(parameters.w1_std))
    return np.exp(-0.5 * ((angles - mean) / std) ** 2).astype(np.float32)


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
    shape = images[0].depth.shape
    depth = np.full(shape, np.nan, np.float32)
    total, colour = np.zeros(shape, np.float32), np.zeros((*shape, 3), np.float32)
    contour = np.zeros(shape, np.uint8)
    for image, found, camera in zip(images, highlights, cameras, strict=True):
        depth = np.fmax(depth, image.depth)
        weight = view_weights(incidence(image, camera, height)[0], found.regions, parameters)
        # the floor keeps a pixel that only oblique views saw, whose weight would vanish in 32 bits
        weight = np.where(image.coloured, np.maximum(weight, 1e-12), 0)
        total += weight
        colour += weight[..., None] * found.inpainted
        contour |= cv2.morphologyEx(found.regions.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((5, 5), np.uint8))
    coloured = total > 0
    merged = colour / np.where(coloured, total, 1)[..., None]
    if contour.any():
        smooth = cv2.blur(merged, (CONTOUR_FILTER, CONTOUR_FILTER))
        merged = np.where((contour > 0)[..., None] & coloured[..., None], smooth, merged)
    return Orthoimage(np.rint(merged).astype(np.uint8), coloured, depth, images[0].pixel_size)
