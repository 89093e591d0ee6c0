"""The D90's sensor and raw converter: from the light on the sensor to a picture of 8 bits; top rows come first."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.bands import bands
from sim.noise import normal_noise
from sim.render.materials import linear_from_srgb, srgb_from_linear

FULL_WELL = 20_900.0
"""Electrons at full scale, ISO 200 (photonstophotos.net, same sensor)."""
READ_NOISE = 11.0
"""Electrons, one sigma, ISO 200."""
LEVELS = 2**12
"""Of the analogue-digital converter."""

Image = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Exposure:
    """What falls on the sensor for a flash of one unit."""

    albedo: NDArray[np.uint8]
    """(H, W, 3) sRGB"""
    light: Image
    """(H, W) of flash and room, on matt surfaces."""
    gloss: Image
    """(H, W) light of the gloss lobes."""
    mirrors: NDArray[np.bool_]
    """(H, W) where the lobe is narrow enough to be a highlight."""


def linear(srgb: NDArray[np.uint8]) -> Image:
    """Decode sRGB to 0 to 1."""
    return np.asarray(cv2.LUT(srgb, _LINEAR), np.float32)


def develop(exposed: Exposure, gain: float, seed: int | None) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Photons, noise, clipping, 12 bit, sRGB.

    Args:
        exposed: the light.
        gain: of a flash of that many units, relative to full scale.
        seed: of the noise; None for none.

    Returns:
        (H, W, 3) sRGB; (H, W) levels by which highlights brighten it, noise aside.
    """
    image, brightening = np.empty_like(exposed.albedo), np.empty_like(exposed.albedo[..., 0])
    noise = np.random.PCG64(seed) if seed is not None else None
    for rows in bands(image.shape):  # each draws a multiple of four numbers: bands do not show in the noise
        shine = exposed.gloss[rows] * np.float32(gain)
        signal = linear(exposed.albedo[rows])
        signal *= _grey(exposed.light[rows] * np.float32(gain))
        highlight = np.flatnonzero(exposed.mirrors[rows] & (shine > 1 / LEVELS))
        matt = _pixels(signal, highlight)
        signal += _grey(shine)
        brightening[rows] = _brightening(matt, _pixels(signal, highlight), highlight, shine.shape)
        if noise is not None:
            signal += _noise(signal, noise)
        image[rows] = _srgb(signal)
    return image, brightening


def _noise(signal: Image, source: np.random.PCG64) -> Image:
    """Of photons and reading; photon noise of more than a few electrons is normal."""
    sigma = signal * np.float32(1 / FULL_WELL)
    sigma += np.float32((READ_NOISE / FULL_WELL) ** 2)
    np.sqrt(sigma, out=sigma)
    sigma *= normal_noise(source, signal.shape)
    return sigma


def _brightening(matt: Image, both: Image, where: NDArray[np.intp], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """(H, W) levels between two developed pictures (N, 1, 3), in the mean of the channels, at some pixels (N,)."""
    levels = np.zeros(shape, np.uint8)
    if len(where):
        red, green, blue = cv2.split((_srgb(both) - _srgb(matt)).astype(np.uint16))
        levels.ravel()[where] = ((red + green + blue + 1) // 3).ravel()
    return levels


def _pixels(picture: Image, where: NDArray[np.intp]) -> Image:
    """(N, 1, 3) some pixels of a picture."""
    return picture.reshape(-1, 1, 3).take(where, axis=0)


def _grey(picture: Image) -> Image:
    """(H, W, 3)"""
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), np.float32)


def _srgb(signal: Image) -> NDArray[np.uint8]:
    """Clip, convert to 12 bits and encode."""
    digital = np.clip(signal, 0, 1)
    digital *= np.float32(LEVELS - 1)
    digital += np.float32(0.5)
    return np.asarray(cv2.LUT(digital.astype(np.uint16), _SRGB), np.uint8)


_LINEAR = linear_from_srgb(np.arange(256) / 255).astype(np.float32)
_SRGB = np.rint(255 * srgb_from_linear(np.minimum(np.arange(2**16) / (LEVELS - 1), 1))).astype(np.uint8)
"""(65536,), as `cv2.LUT` wants it, of 12 bits."""
