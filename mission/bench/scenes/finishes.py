"""Materials and textures with names, for files that people read."""

from __future__ import annotations

from dataclasses import dataclass

from mission.bench.walls import finishes
from mission.bench.walls.finishes import Finish
from mission.bench.walls.textures import Colour

Point = tuple[float, float]


@dataclass(frozen=True)
class Texture:
    """One of MuJoCo's own pictures, which need no file."""

    name: str
    attributes: tuple[tuple[str, str], ...]
    """Of the element in the file."""
    metres: Point
    """Width and height of the picture on a surface [m]."""


@dataclass(frozen=True)
class Named(Finish):
    """A finish that is a material of its own in the file; all else is a colour at the geom."""

    name: str = ""
    texture: Texture | None = None


MATT = Named((0.8, 0.8, 0.8), name="matt")
"""What has no other material."""
KNOWN = {
    finishes.STEEL: "steel",
    finishes.BRASS: "brass",
    finishes.BLACK: "black",
    finishes.WHITE: "white",
    finishes.GLASS: "glass",
    finishes.RED: "red",
    finishes.GREEN: "green",
}
"""Names of the finishes that the furniture brings."""


def named(name: str, colour: Colour, *, gloss: float = 0.0, texture: Texture | None = None) -> Named:
    """A named finish: `gloss` 0 is matt, 1 a lacquer; a texture has its own colours."""
    return Named(
        (1.0, 1.0, 1.0) if texture else colour,
        specular=round(0.015 + 0.35 * gloss, 4),
        roughness=round(0.8 - 0.55 * gloss, 4),
        name=name,
        texture=texture,
    )


def speckled(name: str, colour: Colour, mark: Colour, share: float, metres: Point) -> Texture:
    """Plaster, terrazzo or carpet: random dots of a second colour, 8 mm wide."""
    pixels = tuple(round(side / 0.008) for side in metres)
    return Texture(name, _flat(colour, mark, share, (pixels[0], pixels[1])), metres)


def grained(name: str, colour: Colour, mark: Colour) -> Texture:
    """Wood: upright streaks."""
    return Texture(name, _flat(colour, mark, 0.35, (192, 6)), (1.0, 2.2))


def tiled(name: str, colour: Colour, other: Colour, joint: Colour, metres: float) -> Texture:
    """Tiles of two colours with joints; four of them are `metres` wide and high."""
    attributes = (
        ("builtin", "checker"),
        ("rgb1", _rgb(colour)),
        ("rgb2", _rgb(other)),
        ("width", "256"),
        ("height", "256"),
        ("mark", "edge"),
        ("markrgb", _rgb(joint)),
    )
    return Texture(name, attributes, (metres, metres))


def _flat(colour: Colour, mark: Colour, share: float, pixels: tuple[int, int]) -> tuple[tuple[str, str], ...]:
    return (
        ("builtin", "flat"),
        ("rgb1", _rgb(colour)),
        ("width", str(pixels[0])),
        ("height", str(pixels[1])),
        ("mark", "random"),
        ("markrgb", _rgb(mark)),
        ("random", f"{share:g}"),
    )


def _rgb(colour: Colour) -> str:
    return " ".join(f"{part:g}" for part in colour)
