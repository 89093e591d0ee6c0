"""How a flash lights what a pinhole sees: per pixel, from surface and material alone.

All arrays are pictures with the top row first. Vectors are in view axes: x forward, y up, z right.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.sight import Seen

Image = NDArray[np.floating]
"""float32 throughout."""

_SHADOW_BIAS = 3e-3
"""Depth by which something must be nearer to the flash to throw a shadow, relative."""
_NO_SURFACE = np.float32(1e-9)
"""Length of the normal where there is none [1/m]."""


@dataclass(frozen=True, eq=False)
class Window:
    """Where the pixels of a pinhole picture look."""

    focal_x: float
    """[px]"""
    focal_y: float
    """[px]"""
    across: Image
    """(1, W) tangent of each pixel centre to the right."""
    up: Image
    """(H, 1) tangent of each pixel centre upward."""

    def part(self, rows: slice) -> Window:
        """Some rows of it."""
        return replace(self, up=self.up[rows])


@dataclass(frozen=True, eq=False)
class Gloss:
    """How shiny the surface in each pixel is."""

    height: Image
    """(H, W) height of the Blinn-Phong lobe, relative to a white diffuser."""
    exponent: Image
    """(H, W)"""


@dataclass(frozen=True, eq=False)
class Light:
    """What reaches the camera for a flash of one unit: light 1 on a surface square to it at 1 m."""

    diffuse: Image
    """(H, W) irradiance; times the albedo it is what a matt surface sends back."""
    gloss: Image
    """(H, W) light of the gloss lobe."""


def flash_light(
    seen: Seen, seen_by_flash: NDArray[np.bool_], flash: tuple[float, float], window: Window, gloss: Gloss
) -> Light:
    """Light a picture by a point flash beside the lens.

    Inverse square, Lambert's cosine, Blinn-Phong lobe, hard shadow.

    Args:
        seen: (H, W) along beams (1, up, across), so that inverse ranges are inverse depths.
        seen_by_flash: (H, W) `seen_from_flash` of the same pixels.
        flash: its position right of and above the lens [m].
        window: of the picture.
        gloss: of the surfaces.
    """
    inverse_depth, (ahead, upward, to_right) = seen.inverse_range, seen.slopes  # the normals point away from the lens
    length = np.maximum(np.sqrt(to_right**2 + upward**2 + ahead**2), _NO_SURFACE)
    across, up = window.across, window.up
    away = np.sqrt(across**2 + up**2 + 1)  # length of the ray from the lens (across, up, 1)
    flash_x, flash_y = flash[0] * inverse_depth - across, flash[1] * inverse_depth - up
    reach = np.sqrt(flash_x**2 + flash_y**2 + 1)  # length of the ray to the flash (flash_x, flash_y, -1); both x depth

    facing_flash = np.maximum((ahead - to_right * flash_x - upward * flash_y) / (length * reach), 0)
    facing_lens = inverse_depth / (length * away)
    between = (1 - flash_x * across - flash_y * up) / (reach * away)  # cosine between flash and lens
    half = (facing_flash + facing_lens) / np.sqrt(2 + 2 * between)  # cosine of the normal to the half vector
    irradiance = (inverse_depth / reach) ** 2 * seen_by_flash
    lobe = np.exp(gloss.exponent * np.log(np.clip(half, 1e-6, 1)))
    lobe *= gloss.height
    lobe *= irradiance
    lobe *= facing_flash > 0
    return Light(diffuse=irradiance * facing_flash, gloss=lobe)


def seen_from_flash(
    inverse_depth: Image,
    flash_inverse_depth: Image,
    flash: tuple[float, float],
    window: Window,
    first: tuple[int, int],
) -> NDArray[np.bool_]:
    """(H, W) True where the flash reaches the surface, False in its shadow.

    Args:
        inverse_depth: (H, W) 1/z from the lens [1/m].
        flash_inverse_depth: 1/z from the flash, looking the same way through a larger window [1/m].
        flash: position of the flash right of and above the lens [m].
        window: of the picture from the lens.
        first: column and row of that larger window's pixel that looks the same way as the picture's first one.
    """
    height, width = inverse_depth.shape
    # From the flash, which looks the same way, a point has the same depth and is shifted by the parallax.
    column = np.arange(first[0], first[0] + width, dtype=np.float32)
    row = np.arange(first[1], first[1] + height, dtype=np.float32)[:, None]
    map_x = column - np.float32(window.focal_x * flash[0]) * inverse_depth
    map_y = row + np.float32(window.focal_y * flash[1]) * inverse_depth
    nearest = np.asarray(cv2.remap(flash_inverse_depth, map_x, map_y, cv2.INTER_LINEAR))
    return nearest <= inverse_depth * np.float32(1 + _SHADOW_BIAS)
