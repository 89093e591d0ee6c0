"""What surfaces are made of, and the colours that builders choose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mission.bench.walls import textures
from mission.bench.walls.textures import Colour, Painter

WALL_PAINTS: tuple[Colour, ...] = (
    (0.88, 0.87, 0.83),
    (0.85, 0.82, 0.72),
    (0.78, 0.83, 0.84),
    (0.80, 0.84, 0.76),
    (0.86, 0.78, 0.68),
    (0.76, 0.76, 0.77),
    (0.88, 0.84, 0.62),
    (0.70, 0.76, 0.82),
    (0.84, 0.73, 0.70),
)
DOOR_PAINTS: tuple[Colour, ...] = (
    (0.93, 0.93, 0.92),
    (0.52, 0.55, 0.58),
    (0.20, 0.33, 0.48),
    (0.26, 0.42, 0.34),
    (0.60, 0.20, 0.18),
    (0.36, 0.37, 0.39),
    (0.72, 0.60, 0.30),
)
DADO_PAINTS: tuple[Colour, ...] = (
    (0.42, 0.50, 0.57),
    (0.40, 0.51, 0.43),
    (0.62, 0.52, 0.40),
    (0.50, 0.50, 0.51),
    (0.56, 0.34, 0.29),
)
"""Darker than any wall above them."""
WOODS: tuple[Colour, ...] = ((0.62, 0.44, 0.27), (0.72, 0.56, 0.38), (0.45, 0.29, 0.18), (0.53, 0.36, 0.22))


@dataclass(frozen=True)
class Finish:
    """A surface's look: colour or picture, and gloss."""

    colour: Colour
    """Mean colour, sRGB 0 to 1."""
    painter: Painter | None = None
    """Paints the picture on it; None for plain colour."""
    variation: float = 0.0
    """How much the picture varies, in parts of full scale."""
    period: tuple[float, float] = (2.0, 2.0)
    """Width and height after which the picture repeats [m]."""
    seed: int = 0
    """Of the picture."""
    specular: float = 0.015
    """Height of the gloss lobe, relative to a white diffuser."""
    roughness: float = 0.8
    """Width of the gloss lobe: 0 a mirror, 1 matt."""
    alpha: float = 1.0
    """Below 0.5 it is glass, which light and laser pass."""


STEEL = Finish((0.62, 0.63, 0.65), specular=0.3, roughness=0.4)
BRASS = Finish((0.70, 0.58, 0.32), specular=0.3, roughness=0.4)
BLACK = Finish((0.12, 0.12, 0.13))
WHITE = Finish((0.93, 0.93, 0.92))
GLASS = Finish((0.75, 0.88, 0.90), alpha=0.2)
FROSTED = Finish((0.80, 0.86, 0.87))
RED = Finish((0.75, 0.10, 0.08), specular=0.2, roughness=0.3)
GREEN = Finish((0.10, 0.50, 0.28))


def plain(colour: Colour, *, specular: float = 0.015, roughness: float = 0.8) -> Finish:
    """One colour."""
    return Finish(colour, specular=specular, roughness=roughness)


def plaster(rng: np.random.Generator, colour: Colour, variation: float = 0.055) -> Finish:
    """Painted plaster; by section 7.2.2 of the paper even a plain wall varies by 5 %."""
    return Finish(colour, textures.plaster, variation, seed=seed(rng))


def wood(rng: np.random.Generator, colour: Colour, variation: float = 0.12) -> Finish:
    """Veneer with upright grain."""
    return Finish(colour, textures.grain, variation, (0.9, 2.1), seed(rng))


def glossy(rng: np.random.Generator, finish: Finish) -> Finish:
    """Gloss paint, lacquer or glaze: highlights of the flash cover some 8 cm2 to 0.27 m2 of a wall (section 7.4)."""
    return replace(finish, specular=float(rng.uniform(0.2, 0.45)), roughness=_roughness(rng, 0.14, 0.28))


def lacquer(rng: np.random.Generator, finish: Finish, *, large: bool = False) -> Finish:
    """A smooth coat, whose highlights are overexposed: small ones or large ones, of up to 0.27 m2 seen from 4 m.

    Its surface reflects 4 % of the light (Fresnel, index 1.5) in a Blinn-Phong lobe, which conserves energy if it is
    (n + 8) / 8 * 4 % of a white diffuser high, for an exponent n; some of the coat is dull.
    """
    roughness = _roughness(rng, 0.21, 0.24) if large else _roughness(rng, 0.17, 0.19)
    height = float(rng.uniform(0.75, 1.0)) * 0.04 * (2 / roughness**4 + 6) / 8
    return replace(finish, specular=height, roughness=roughness)


def smoother(coat: Finish) -> Finish:
    """The same coat with highlights of 0.4 times the area, and as much light in them."""
    return replace(coat, roughness=0.8 * coat.roughness, specular=coat.specular / 0.8**4)


def _roughness(rng: np.random.Generator, smallest: float, largest: float) -> float:
    """Of a gloss coat; the area of a highlight grows like its fourth power, and all areas are as likely."""
    return float(rng.uniform(smallest**4, largest**4)) ** 0.25


def floor(rng: np.random.Generator) -> Finish:
    """A floor covering."""
    kinds = (
        (textures.planks, (0.55, 0.42, 0.30), 0.14, (1.6, 1.2)),
        (textures.tiles, (0.60, 0.57, 0.52), 0.06, (1.6, 1.6)),
        (textures.carpet, (0.36, 0.40, 0.45), 0.10, (1.0, 1.0)),
        (textures.plaster, (0.50, 0.51, 0.50), 0.08, (2.0, 2.0)),
    )
    painter, colour, variation, period = kinds[rng.integers(len(kinds))]
    return Finish(jittered(rng, colour, 0.06), painter, variation, period, seed(rng))


def pick(rng: np.random.Generator, colours: tuple[Colour, ...], spread: float = 0.03) -> Colour:
    """One of the colours, from another tin each time."""
    return jittered(rng, colours[rng.integers(len(colours))], spread)


def unlike(rng: np.random.Generator, colours: tuple[Colour, ...], other: Colour, least: float = 0.15) -> Colour:
    """One of the colours that differs from another by so much in at least one channel; if none does, the farthest."""
    differences = [max(abs(a - b) for a, b in zip(colour, other, strict=True)) for colour in colours]
    bar = min(least + 0.03, max(differences))
    return pick(rng, tuple(c for c, difference in zip(colours, differences, strict=True) if difference >= bar))


def mixed(colour: Colour, other: Colour) -> Colour:
    """Halfway between two colours."""
    r, g, b = (0.5 * np.add(colour, other)).tolist()
    return r, g, b


def jittered(rng: np.random.Generator, colour: Colour, spread: float) -> Colour:
    """A colour moved a little, mostly in brightness."""
    moved = np.array(colour) + rng.uniform(-spread, spread) + 0.3 * rng.uniform(-spread, spread, 3)
    r, g, b = np.clip(moved, 0.03, 0.97).tolist()
    return (r, g, b)


def shifted(finish: Finish, change: Colour) -> Finish:
    """The same finish in a colour that differs by so much in each channel."""
    r, g, b = np.clip(np.add(finish.colour, change), 0, 1).tolist()
    return replace(finish, colour=(r, g, b))


def seed(rng: np.random.Generator) -> int:
    """A seed for a picture."""
    return int(rng.integers(2**31))
