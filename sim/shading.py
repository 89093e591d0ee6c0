"""How a flash lights what a pinhole sees: per pixel, from depth and material alone.

All arrays are pictures with the bottom row first. Vectors are in view axes: x right, y up, z forward.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.floating]
"""float32 throughout."""

_SHADOW_BIAS = 3e-3
"""Depth by which something must be nearer to the flash to throw a shadow, relative."""
_DOUBT = np.float32(0.1)
"""Weight of the size of a step, beside its change, in the choice between two."""
NEIGHBOURS = 2
"""Rows on either side of a pixel that its light depends on."""


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
    inverse_depth: Image, seen_by_flash: NDArray[np.bool_], flash: tuple[float, float], window: Window, gloss: Gloss
) -> Light:
    """Light a picture by a point flash beside the lens.

    Inverse square, Lambert's cosine, Blinn-Phong lobe, hard shadow.

    Args:
        inverse_depth: (H, W) 1/z at the pixel centres [1/m]; nearly 0 where there is nothing.
        seen_by_flash: (H, W) `seen_from_flash` of the same pixels.
        flash: its position right of and above the lens [m].
        window: of the picture.
        gloss: of the surfaces.
    """
    to_right, upward, ahead = _gradient(inverse_depth, window)  # the normal, pointing away, by an unknown length
    length = np.sqrt(to_right**2 + upward**2 + ahead**2)
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
    map_y = row - np.float32(window.focal_y * flash[1]) * inverse_depth
    nearest = np.asarray(cv2.remap(flash_inverse_depth, map_x, map_y, cv2.INTER_LINEAR))
    return nearest <= inverse_depth * np.float32(1 + _SHADOW_BIAS)


def _gradient(inverse_depth: Image, window: Window) -> tuple[Image, Image, Image]:
    """Normals away from the lens, each divided by the distance of its plane: three (H, W) components.

    Over a plane 1/z is linear in the tangents (u, v): its slopes, and its value at u = v = 0, are these components.
    """
    to_right = slope_on_surface(inverse_depth, axis=1) * np.float32(window.focal_x)
    upward = slope_on_surface(inverse_depth, axis=0) * np.float32(window.focal_y)
    return to_right, upward, inverse_depth - window.across * to_right - window.up * upward


def slope_on_surface(picture: Image, axis: int) -> Image:
    """(H, W) change per pixel, of the steps before and after each pixel the one on the pixel's own surface.

    That is the step that goes on unchanged to the pixel beyond; where neither does, the smaller one. A pixel's slope
    depends on its `NEIGHBOURS` on either side.
    """
    steps = np.diff(picture, axis=axis)
    change = np.abs(np.diff(steps, axis=axis))
    after_doubt = np.abs(steps) * _DOUBT
    before_doubt = after_doubt.copy()
    _part(before_doubt, axis, 1, None)[...] += change
    _part(after_doubt, axis, 0, -1)[...] += change
    chosen = _part(after_doubt, axis, 1, None) < _part(before_doubt, axis, 0, -1)
    before, after = _part(steps, axis, 0, -1), _part(steps, axis, 1, None)
    inner = np.asarray(cv2.copyTo(after, chosen.view(np.uint8), before.copy()))
    return np.concatenate([_part(steps, axis, 0, 1), inner, _part(steps, axis, -1, None)], axis)


def _part(picture: Image, axis: int, start: int, stop: int | None) -> Image:
    return picture[start:stop] if axis == 0 else picture[:, start:stop]
