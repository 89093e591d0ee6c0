"""How a flash lights what a pinhole sees: per pixel, from depth and material alone.

All arrays are pictures with the bottom row first. Vectors are in view axes: x right, y up, z forward.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.floating]
"""float32 throughout."""

_SHADOW_BIAS = 3e-3
"""Depth by which something must be nearer to the flash to throw a shadow, relative."""
_DOUBT = np.float32(0.1)
"""Weight of the size of a step, beside its change, in the choice between two."""


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
    inverse_depth: Image, seen_by_flash: Image, flash: tuple[float, float], window: Window, gloss: Gloss
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
    margin: tuple[int, int],
) -> Image:
    """(H, W) 1 where the flash reaches the surface, 0 in its shadow.

    Args:
        inverse_depth: (H, W) 1/z from the lens [1/m].
        flash_inverse_depth: 1/z from the flash, looking the same way through a window that is larger by the margin on
            all sides [1/m].
        flash: position of the flash right of and above the lens [m].
        window: of the picture from the lens.
        margin: columns and rows [px].
    """
    height, width = inverse_depth.shape
    # From the flash, which looks the same way, a point has the same depth and is shifted by the parallax.
    column = np.arange(width, dtype=np.float32) + np.float32(margin[0])
    row = np.arange(height, dtype=np.float32)[:, None] + np.float32(margin[1])
    map_x = column - np.float32(window.focal_x * flash[0]) * inverse_depth
    map_y = row - np.float32(window.focal_y * flash[1]) * inverse_depth
    nearest = cv2.remap(flash_inverse_depth, map_x, map_y, cv2.INTER_LINEAR)
    return (nearest <= inverse_depth * np.float32(1 + _SHADOW_BIAS)).astype(np.float32)


def _gradient(inverse_depth: Image, window: Window) -> tuple[Image, Image, Image]:
    """Normals away from the lens, each divided by the distance of its plane: three (H, W) components.

    Over a plane 1/z is linear in the tangents (u, v): its slopes, and its value at u = v = 0, are these components.
    """
    to_right = slope_on_surface(inverse_depth, axis=1) * np.float32(window.focal_x)
    upward = slope_on_surface(inverse_depth, axis=0) * np.float32(window.focal_y)
    return to_right, upward, inverse_depth - window.across * to_right - window.up * upward


def slope_on_surface(picture: Image, axis: int) -> Image:
    """(H, W) change per pixel, of the steps before and after each pixel the one on the pixel's own surface.

    That is the step that goes on unchanged to the pixel beyond; where neither does, the smaller one.
    """
    widths = [(0, 0), (0, 0)]
    widths[axis] = (2, 2)
    steps = np.pad(np.diff(picture, axis=axis), widths, mode="edge")
    doubt = np.abs(np.diff(steps, axis=axis))
    size = picture.shape[axis]
    before, after = _part(steps, axis, 1, size), _part(steps, axis, 2, size)
    doubt_before = _part(doubt, axis, 0, size) + np.abs(before) * _DOUBT
    doubt_after = _part(doubt, axis, 2, size) + np.abs(after) * _DOUBT
    return np.asarray(cv2.copyTo(after, (doubt_after < doubt_before).view(np.uint8), before.copy()))


def _part(picture: Image, axis: int, start: int, size: int) -> Image:
    return picture[start : start + size] if axis == 0 else picture[:, start : start + size]
