"""Pictures on surfaces: plaster, tiles, wood, boards, posters. (H, W, 3) uint8 sRGB, top row first, all repeatable."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Colour = tuple[float, float, float]
"""sRGB, 0 to 1."""
Picture = NDArray[np.uint8]
Painter = Callable[[np.random.Generator, Colour, float], Picture]
"""Paints a picture from its source of chance, its mean colour and how much it varies, in parts of full scale."""

_TILES = 4
_BOARDS = 6


def plaster(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Painted plaster: fine grain on soft clouds."""
    noise = 0.6 * _noise(rng, (256, 256), (5, 5)) + 0.25 * _noise(rng, (256, 256), (32, 32))
    noise += 0.15 * _noise(rng, (256, 256), (128, 128))
    return _painted(colour, variation * _spread(noise))


def mottled(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Uneven, stained paint: large soft clouds, somewhat different in each colour."""
    shape = (192, 384)
    common = _noise(rng, shape, (3, 5)) + 0.5 * _noise(rng, shape, (6, 11))
    channels = [_spread(common + 0.15 * _noise(rng, shape, (3, 5))) for _ in range(3)]
    return _painted(colour, variation * np.stack(channels, axis=-1))


def tiles(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Ceramic tiles, four by four, each from another firing, with grout between."""
    side = 64
    tones = variation * _spread(
        rng.standard_normal((_TILES, _TILES, 1)) + 0.2 * rng.standard_normal((_TILES, _TILES, 3))
    )
    picture = np.array(colour) + np.kron(tones, np.ones((side, side, 1)))
    grout = np.arange(side * _TILES) % side < 1
    picture[grout[:, None] | grout[None]] = 0.82 * np.array(colour)
    return _bytes(picture)


def bricks(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Bricks in stretcher bond."""
    rows, columns, height, width = 8, 4, 32, 64
    tones = variation * rng.uniform(-0.5, 0.5, (rows, columns, 1))
    picture = np.array(colour) + np.kron(tones, np.ones((height, width, 1)))
    picture[np.arange(rows * height) % height < 4] = 0.75
    upright = np.arange(columns * width) % width < 4
    picture[:, upright] = 0.75
    for row in range(1, rows, 2):
        course = slice(row * height, (row + 1) * height)
        picture[course] = np.roll(picture[course], width // 2, axis=1)
    return _bytes(picture)


def grain(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Veneer: streaks that run up."""
    return _painted(colour, variation * _streaks(rng, (256, 256), waves=40))


def boards(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Upright wooden boards, each from another tree, with dark grooves between."""
    width = 64
    streaks = _streaks(rng, (256, _BOARDS * width), waves=90)
    tones = np.repeat(rng.uniform(-0.5, 0.5, _BOARDS), width)
    picture = np.array(colour) + variation * (0.6 * streaks + 0.7 * tones)[..., None]
    picture[:, np.arange(_BOARDS * width) % width < 2] *= 0.6
    return _bytes(picture)


def planks(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """A floor of planks: boards, lying."""
    return np.ascontiguousarray(np.rot90(boards(rng, colour, variation)))


def carpet(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """Speckled floor covering."""
    noise = rng.standard_normal((128, 128)) * 0.2 + 0.3 * _noise(rng, (128, 128), (8, 8))
    return _painted(colour, variation * np.clip(noise, -0.5, 0.5))


def poster(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """A printed sheet: a heading, some pictures, lines of text."""
    picture = np.full((192, 128, 3), colour)
    for _ in range(rng.integers(2, 5)):
        top, left = rng.integers(40, 130), rng.integers(8, 70)
        high, wide = rng.integers(20, 50), rng.integers(25, 60)
        shade = np.linspace(0, 1, high)[:, None, None]
        first, second = rng.uniform(0.1, 0.95, 3), rng.uniform(0.1, 0.95, 3)
        block = picture[top : top + high, left : min(left + wide, 120)]
        block[:] = (first * (1 - shade) + second * shade)[: len(block)]
    ink = np.clip(np.array(colour) - 0.6 * np.sign(np.mean(colour) - 0.45), 0.05, 0.95)
    picture[12 : 12 + int(rng.integers(8, 20)), 10 : int(rng.integers(60, 118))] = ink
    for row in range(150, 184, 6):
        picture[row : row + 2, 10 : int(rng.integers(70, 118))] = ink
    return _bytes(picture + variation * (rng.random((192, 128, 1)) - 0.5))


def sign(rng: np.random.Generator, colour: Colour, variation: float) -> Picture:
    """A safety sign: a pale pictogram with a rim on a plain ground."""
    picture = np.full((64, 96, 3), colour)
    picture[4:60, 4:92] = 0.95
    picture[7:57, 7:89] = colour
    picture[18:46, 14:40] = 0.95
    left = int(rng.integers(46, 56))
    picture[28:36, left:82] = 0.95
    return _bytes(picture + variation * (rng.random((64, 96, 1)) - 0.5))


def _noise(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[int, int]) -> NDArray[np.float64]:
    """(H, W) smooth noise from a lattice of so many cells, repeatable."""
    values = rng.standard_normal(cells)
    for axis in (0, 1):
        at = np.arange(shape[axis]) * cells[axis] / shape[axis]
        first = at.astype(int)
        share = (at - first) ** 2 * (3 - 2 * (at - first))
        share = share[:, None] if axis == 0 else share
        second = (first + 1) % cells[axis]
        values = values.take(first, axis) * (1 - share) + values.take(second, axis) * share
    return values


def _streaks(rng: np.random.Generator, shape: tuple[int, int], waves: int) -> NDArray[np.float64]:
    noise = _noise(rng, shape, (3, waves)) + 0.6 * _noise(rng, shape, (6, waves * 2)) + _noise(rng, shape, (2, 6))
    return _spread(noise)


def _spread(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The values moved and scaled to -0.5 ... 0.5."""
    low, high = values.min(), values.max()
    return np.asarray((values - low) / (high - low) - 0.5)


def _painted(colour: Colour, change: NDArray[np.float64]) -> Picture:
    return _bytes(np.array(colour) + (change if change.ndim == 3 else change[..., None]))


def _bytes(picture: NDArray[np.float64]) -> Picture:
    return np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8)
