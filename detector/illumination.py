"""Flash fall-off of a view: what the photographs owe to distance and incidence instead of to the wall (ours).

Section 4 takes the photographs as they are. A flash close to the camera lights a wall by cos(incidence) / range^2, so
that views differ by tens of percent; a law with two unknowns (ambient light, flash) cannot swallow a door.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.orthoimage import WallPoints
from detector.result import Mask, Orthoimage

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
    ranges = np.sqrt((u - origin[0]) ** 2 + (v - origin[1]) ** 2 + origin[2] ** 2).astype(np.float32)
    return np.arccos(np.clip(np.float32(origin[2]) / ranges, -1, 1)), ranges


def without_falloff(image: Orthoimage, points: WallPoints, height: float, on_face: Mask) -> Orthoimage:
    """The view as if its light were even: divided by the fall-off fitted to its own wall pixels.

    Args:
        on_face: (H, W) pixels to fit to.
    """
    usable = on_face & image.coloured
    if usable.sum() < 50 * BINS:
        return image
    angles, ranges = incidence(image, points.camera, height)
    law = np.cos(angles) / ranges**2
    luminance = LINEAR[image.colour].mean(axis=2)
    ambient, flash = _fit(law[usable], luminance[usable])
    expected = ambient + flash * law
    gain = np.where(expected > 0, np.median(expected[usable]) / np.maximum(expected, 1e-6), 1.0)
    return Orthoimage(_scaled(image.colour, np.clip(gain, 0.25, 4.0)), image.coloured, image.depth, image.pixel_size)


def _fit(law: NDArray, luminance: NDArray) -> tuple[float, float]:
    """Ambient light and flash, none negative, from the median luminance of equally filled bins."""
    order = np.argsort(law[:: 1 + len(law) // 100_000], kind="stable")
    law, luminance = law[:: 1 + len(law) // 100_000][order], luminance[:: 1 + len(luminance) // 100_000][order]
    edges = np.linspace(0, len(law), BINS + 1).astype(int)
    x = np.array([np.median(law[a:b]) for a, b in zip(edges[:-1], edges[1:], strict=True)])
    y = np.array([np.median(luminance[a:b]) for a, b in zip(edges[:-1], edges[1:], strict=True)])
    i, j = np.triu_indices(BINS, 3)
    slope = max(0.0, float(np.median((y[j] - y[i]) / np.maximum(x[j] - x[i], 1e-9))))  # Theil-Sen
    ambient = float(np.median(y - slope * x))
    if ambient < 0:
        return 0.0, float(np.median(y / x))
    return ambient, slope


def _scaled(colour: NDArray[np.uint8], gain: NDArray) -> NDArray[np.uint8]:
    """sRGB colours after multiplying their linear light."""
    light = np.linspace(0, 1, SRGB_TABLE + 1)
    table = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055) * 255
    scaled = np.minimum(LINEAR[colour] * gain[..., None].astype(np.float32), 1)
    return np.rint(table[(scaled * SRGB_TABLE + 0.5).astype(np.int32)]).astype(np.uint8)


def equalised(images: list[Orthoimage], on_face: list[Mask]) -> list[Orthoimage]:
    """Views brought to the brightness of those before them, by the median ratio where they overlap."""
    result: list[Orthoimage] = []
    for k, image in enumerate(images):
        ratios = []
        for reference, face in zip(result, on_face[:k], strict=True):
            both = face & on_face[k] & reference.coloured & image.coloured
            if both.sum() >= 500:
                light = [LINEAR[i.colour[both][:: 1 + both.sum() // 50_000]].mean(axis=1) for i in (reference, image)]
                ratios.append((float(np.median(light[0] / np.maximum(light[1], 1e-4))), int(both.sum())))
        if ratios:
            gain = np.average([r for r, _ in ratios], weights=[n for _, n in ratios])
            colour = _scaled(image.colour, np.full(image.depth.shape, np.clip(gain, 0.25, 4.0)))
            image = Orthoimage(colour, image.coloured, image.depth, image.pixel_size)
        result.append(image)
    return result
