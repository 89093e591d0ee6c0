"""What the surfaces of a model are made of: tables by geom id, with one row more for anything that is no geom."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.render.visibility import effective_rgba

_DEFAULT_SPECULAR = _DEFAULT_SHININESS = 0.5
"""MJCF's defaults, also those of a geom without a material."""
_SHININESS_TO_EXPONENT = 128.0
"""MuJoCo's own factor from shininess to OpenGL's Phong exponent (render_gl3.c)."""
_TEXELS = 4096
"""Number of texels that the mean colour of a texture is taken from."""


@dataclass(frozen=True, eq=False)
class Materials:
    """Tables of (ngeom + 1,) rows; the last one, index -1, is for flexes, skins and nothing."""

    colour: NDArray[np.float32]
    """(ngeom + 1, 3) mean linear reflectance in red, green and blue, 0 to 1, texture included."""
    specular: NDArray[np.float32]
    """Height of the gloss lobe, relative to a white diffuser."""
    exponent: NDArray[np.float32]
    """Blinn-Phong exponent of the gloss lobe."""


def materials_of(model: mujoco.MjModel) -> Materials:
    """Read the materials of a model.

    The exponent is 128 x shininess, as in MuJoCo's own OpenGL; where the material states a roughness r, it is the
    exponent of the same width as a microfacet lobe of that roughness, 2/r^4 - 2 (Walter et al. 2007, alpha = r^2).
    """
    material = model.geom_matid
    specular = np.append(model.mat_specular, _DEFAULT_SPECULAR)[material]
    exponent = np.append(_exponents(model), _SHININESS_TO_EXPONENT * _DEFAULT_SHININESS)[material]
    return Materials(
        colour=np.vstack([_mean_colours(model), np.full((1, 3), 0.5)]).astype(np.float32),
        specular=np.append(specular, _DEFAULT_SPECULAR).astype(np.float32),
        exponent=np.append(exponent, _SHININESS_TO_EXPONENT * _DEFAULT_SHININESS).astype(np.float32),
    )


def linear_from_srgb(colour: NDArray[np.floating]) -> NDArray[np.floating]:
    """Decode sRGB, 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(light: NDArray[np.floating]) -> NDArray[np.floating]:
    """Encode sRGB, 0 to 1 (IEC 61966-2-1)."""
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def _exponents(model: mujoco.MjModel) -> NDArray[np.float64]:
    """(nmat,) Blinn-Phong exponents; a negative roughness means that none is stated."""
    roughness = np.clip(model.mat_roughness, 0.05, 1)
    return np.where(model.mat_roughness >= 0, 2 / roughness**4 - 2, _SHININESS_TO_EXPONENT * model.mat_shininess)


def _mean_colours(model: mujoco.MjModel) -> NDArray[np.floating]:
    """(ngeom, 3) mean linear colour of each geom."""
    rgba = effective_rgba(model)[:, :3].astype(np.float64)
    textures = np.append(model.mat_texid[:, mujoco.mjtTextureRole.mjTEXROLE_RGB], -1)[model.geom_matid]
    colours = linear_from_srgb(rgba)
    pairs = np.column_stack([textures, rgba])[textures >= 0]
    for pair in np.unique(pairs, axis=0):
        same = (textures == pair[0]) & (rgba == pair[1:]).all(axis=1)
        colours[same] = linear_from_srgb(_texels(model, int(pair[0])) * pair[1:]).mean(axis=0)
    return colours


def _texels(model: mujoco.MjModel, texture: int) -> NDArray[np.floating]:
    """(N, 3) some texels of a texture, 0 to 1, spread evenly over it."""
    channels = int(model.tex_nchannel[texture])
    count = int(model.tex_height[texture]) * int(model.tex_width[texture])
    start = int(model.tex_adr[texture])
    texels = model.tex_data[start : start + count * channels].reshape(count, channels)
    stride = max(1, count // _TEXELS) | 1  # odd: does not fall into step with a checkerboard
    colours = texels[::stride, :3] / 255.0
    return colours if channels >= 3 else np.repeat(colours[:, :1], 3, axis=1)
