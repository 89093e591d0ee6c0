"""Flash fall-off of a view: what the photographs owe to distance and incidence instead of to the wall (ours).

Section 4 takes the photographs as they are. A flash close to the camera lights a wall by cos(incidence) / range^2, so
that views differ by tens of percent; a law with two unknowns (ambient light, flash) cannot swallow a door.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.parallel import each
from detector.result import Image, Mask, Orthoimage

SAMPLES = 50_000
"""Pixels that are enough to measure light on."""
LEAST_OVERLAP = 500
"""Pixels that two views must share to be compared."""
BINS = 24
"""Quantiles of the fall-off that the light is measured in."""
STEPS = np.arange(256) / 255.0
LINEAR = np.where(STEPS <= 0.04045, STEPS / 12.92, ((STEPS + 0.055) / 1.055) ** 2.4).astype(np.float32)
"""Linear light of each sRGB value (IEC 61966-2-1)."""
SRGB_TABLE = 4096


def pixel_grid(shape: tuple[int, int], pixel_size: float, height: float) -> tuple[NDArray, NDArray]:
    """u of the columns (1, W) and v of the rows (H, 1), of pixel centres [m]."""
    u = (np.arange(shape[1], dtype=np.float32) + 0.5) * pixel_size
    v = height - (np.arange(shape[0], dtype=np.float32) + 0.5) * pixel_size
    return u[None, :], v[:, None]


def incidence(image: Orthoimage, origin: NDArray[np.float64], height: float) -> tuple[NDArray, NDArray]:
    """Incidence angle [rad] and range [m] of each pixel (H, W), seen from a point in wall coordinates."""
    u, v = pixel_grid(image.depth.shape, image.pixel_size, height)
    squares = (u - origin[0]) ** 2 + ((v - origin[1]) ** 2 + origin[2] ** 2)
    ranges = np.sqrt(squares, out=squares).astype(np.float32)
    cosines = np.float32(origin[2]) / ranges
    return np.arccos(np.clip(cosines, -1, 1, out=cosines), out=cosines), ranges


def even_light(
    images: Sequence[Orthoimage], cameras: Sequence[NDArray[np.float64]], height: float, faces: Sequence[Mask]
) -> list[Orthoimage]:
    """The views as if their light were even and the same: each divided by the fall-off fitted to its own wall pixels,
    and brought to the brightness of the views before it by the median ratio where they overlap.

    Args:
        cameras: (3,) centre of each view's camera in wall coordinates [m].
        height: Height of the wall [m].
        faces: (H, W) for each view: pixels of the wall's face.
    """
    lit = list(zip(images, cameras, faces, strict=True))
    gains = each(lambda view: falloff_gain(view[0], view[1], height, view[2]), lit)
    for k, (image, _, face) in enumerate(lit):
        ratios = [_ratio((images[j], gains[j], faces[j]), (image, gains[k], face)) for j in range(k)]
        weights = [n for _, n in ratios]
        if sum(weights) > 0:
            mean = np.average([r for r, _ in ratios], weights=weights)
            gains[k] = gains[k] * np.float32(np.clip(mean, 0.25, 4.0))
    colours = each(lambda view: _scaled(view[0].colour, view[1]), zip(images, gains, strict=True))
    return [replace(image, colour=colour) for image, colour in zip(images, colours, strict=True)]


def falloff_gain(image: Orthoimage, camera: NDArray[np.float64], height: float, face: Mask) -> NDArray[np.float32]:
    """(H, W) factor on the linear light that takes the flash's fall-off out; 1 where there is too little to fit."""
    usable = face & image.coloured
    if usable.sum() < 50 * BINS:
        return np.ones(face.shape, np.float32)
    angles, ranges = incidence(image, camera, height)
    law = np.cos(angles) / ranges**2
    some = np.flatnonzero(usable)
    some = some[:: 1 + len(some) // SAMPLES]
    light = LINEAR[image.colour.reshape(-1, 3)[some]].mean(axis=1)
    ambient, flash = _fit(law.ravel()[some], light)
    if ambient + flash <= 0:  # black, whatever the light
        return np.ones(face.shape, np.float32)
    expected = ambient + flash * law
    typical = np.median(expected.ravel()[some])
    np.maximum(expected, 1e-6, out=expected)
    return np.clip(np.divide(typical, expected, out=expected), 0.25, 4.0, out=expected)


def _ratio(reference: tuple[Orthoimage, NDArray, Mask], other: tuple[Orthoimage, NDArray, Mask]) -> tuple[float, int]:
    """Median ratio of the light of two views (image, gain, face) on the wall that both see, and how much that is."""
    both = np.flatnonzero(reference[2] & other[2] & reference[0].coloured & other[0].coloured)
    if len(both) < LEAST_OVERLAP:
        return 1.0, 0
    some = both[:: 1 + len(both) // SAMPLES]
    one, two = (LINEAR[i.colour.reshape(-1, 3)[some]].mean(axis=1) * g.ravel()[some] for i, g, _ in (reference, other))
    return float(np.median(one / np.maximum(two, 1e-4))), len(both)


def _fit(law: NDArray, luminance: NDArray) -> tuple[float, float]:
    """Ambient light and flash, none negative, from the median luminance of equally filled bins."""
    order = np.argsort(law, kind="stable")
    law, luminance = law[order], luminance[order]
    edges = np.linspace(0, len(law), BINS + 1).astype(int)
    x = np.array([np.median(law[a:b]) for a, b in zip(edges[:-1], edges[1:], strict=True)])
    y = np.array([np.median(luminance[a:b]) for a, b in zip(edges[:-1], edges[1:], strict=True)])
    i, j = np.triu_indices(BINS, 3)
    slope = max(0.0, float(np.median((y[j] - y[i]) / np.maximum(x[j] - x[i], 1e-9))))  # Theil-Sen
    ambient = float(np.median(y - slope * x))
    if ambient < 0:
        return 0.0, float(np.median(y / x))
    return ambient, slope


def _scaled(colour: Image, gain: NDArray[np.float32]) -> Image:
    """sRGB colours after multiplying their linear light."""
    light = np.linspace(0, 1, SRGB_TABLE + 1)
    table = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055) * 255
    scaled = np.asarray(cv2.multiply(cv2.LUT(colour, LINEAR), cv2.merge([gain] * 3)), np.float32)
    np.minimum(scaled, 1, out=scaled)
    scaled *= SRGB_TABLE
    scaled += 0.5
    return np.rint(table).astype(np.uint8).take(scaled.astype(np.intp))
