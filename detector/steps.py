"""What changes across the sides of a rectangle, and whether it is a surface of its own (ours, for section 6.2)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.candidates import Boxes, Scene, Strip, strips
from detector.result import Image, Mask

FAINT_COLOUR = 0.008
"""Least difference of colour on all sides that sets a surface apart, of 1: two grey values."""
FAINT_DEPTH = 0.0012
"""Least difference of depth on all sides that sets a surface apart [m]: 0.1 mm is noise."""
WALL_ROUND, WALL_BESIDE = 0.5, 0.3
"""Least share of wall area round a surface of nearly the wall's colour, and on each side of it."""
BAND = 0.05
"""Width of the upright bands that boards are told by [m]."""
UNLIKE = 4.0
"""How many times as much boards differ as the colour along each of them; tiles differ as much along a column."""
SAME_COLOUR = 0.02
"""Colours closer than this in every channel are the same, of 1."""
SAME_DEPTH = 0.006
"""Depths closer than this are the same [m]."""
UNLIKE_COLOUR, UNLIKE_DEPTH = 0.1, 0.015
"""Surfaces that differ by more are surely two, of 1 and [m]."""
LITTLE = 0.05
"""Least share of a rectangle that is a part of it, not the blur along its sides."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Differences across the left, top and right sides of one rectangle, inside minus outside; NaN where hidden."""

    colour: NDArray[np.float64]
    """(3, 3) side x channel, of 1."""
    depth: NDArray[np.float64]
    """(3,) [m]."""
    wall_outside: NDArray[np.float64]
    """(3,) share of the strip outside that is wall area."""

    def are_real(self) -> bool:
        """Whether no side has the same surface on both sides, as the groove of a panel or plank has.

        Wall outside will do: a door may have the wall's colour.
        """
        same = (np.abs(self.colour).max(axis=1) < SAME_COLOUR) & (np.abs(self.depth) < SAME_DEPTH)
        return not (same & (self.wall_outside < 0.4)).any()

    def framed(self) -> bool:
        """Whether there is no wall on any side: a frame of another colour."""
        return bool(self.wall_outside.max() < WALL_BESIDE)

    def agree(self) -> bool:
        """Whether the inside differs in one way from wall on all visible sides: a surface of its own."""
        if self.wall_outside.min() < WALL_BESIDE or self.wall_outside.mean() < WALL_ROUND:
            return False
        values = np.column_stack([self.colour / FAINT_COLOUR, self.depth / FAINT_DEPTH])
        values = values[~np.isnan(values).any(axis=1)]
        return len(values) >= 2 and bool(((values >= 1).all(axis=0) | (values <= -1).all(axis=0)).any())


def is_set_apart(box: Boxes, scene: Scene, *, boards: bool = True) -> bool:
    """Whether one rectangle is a surface of its own.

    All its sides differ from the wall in one way, or a frame lies between, or boards make them differ by chance.

    Args:
        boards: False does not accept the last.
    """
    change = steps(box, scene)
    if change.framed():
        return True
    return (change.agree() or (boards and boarded(box, scene))) and not holds_wall(box, scene)


def holds_wall(box: Boxes, scene: Scene) -> bool:
    """Whether the wall area within one rectangle is the lesser part of it, and another surface than the rest.

    A door that the wall area has swallowed is wall but for its fittings; between a screen and the sideboard below it
    there is wall.
    """
    inner = np.s_[int(box.top[0]) + 2 : scene.lowest_row : 2, int(box.left[0]) + 2 : int(box.right[0]) - 1 : 2]
    depth = scene.merged.depth[inner]
    known = scene.merged.coloured[inner] & scene.visible[inner] & np.isfinite(depth)
    wall = known & scene.wall[inner]
    if not LITTLE * np.count_nonzero(known) < np.count_nonzero(wall) < np.count_nonzero(known) / 2:
        return False
    rest = known & ~wall
    colours = scene.merged.colour[inner]
    colour = float(np.abs(median_colour(colours, wall) - median_colour(colours, rest)).max())
    step = abs(float(np.median(depth[wall])) - float(np.median(depth[rest])))
    return colour > UNLIKE_COLOUR or step > UNLIKE_DEPTH


def boarded(box: Boxes, scene: Scene) -> bool:
    """Whether the colour within one rectangle changes from board to board, and not along them.

    It changes across the sides by chance then.
    """
    band = max(1, round(BAND / scene.merged.pixel_size))
    rows = slice(int(box.top[0]) + band, scene.lowest_row)
    columns = slice(int(box.left[0]) + band, int(box.right[0]) - band)
    known = scene.merged.coloured[rows, columns] & scene.visible[rows, columns]
    if not known.any():
        return False
    size = max(1, known.shape[1] // band), max(1, known.shape[0] // band)
    weight, colour = (
        cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        for image in (
            known.astype(np.float32),
            np.where(known[..., None], scene.merged.colour[rows, columns], 0) / 255.0,
        )
    )
    colour = np.where(weight[..., None] > 0.5, colour / np.maximum(weight, 0.5)[..., None], np.nan)
    with_data = np.isfinite(colour).any(axis=(0, 2))
    if with_data.sum() < 3:
        return False
    boards = np.nanmedian(colour[:, with_data], axis=0)
    across = boards.std(axis=0).max()
    along = np.nanmedian(np.abs(colour[:, with_data] - boards), axis=(0, 1)).max()
    return bool(across > max(FAINT_COLOUR, UNLIKE * along))


def steps(box: Boxes, scene: Scene) -> Steps:
    """What changes across the sides of one rectangle, by medians over strips."""
    colour, depth, wall = np.full((3, 3), np.nan), np.full(3, np.nan), np.ones(3)
    sides = zip(strips(box, scene, outside=False), strips(box, scene, outside=True), strict=True)
    for i, (inner, outer) in enumerate(sides):
        inside, outside = _strip(inner[0], scene), _strip(outer[0], scene)
        if inside and outside:
            colour[i], depth[i] = inside.colour - outside.colour, inside.depth - outside.depth
            wall[i] = outside.wall
    return Steps(colour, depth, wall)


def _strip(corners: NDArray[np.int64], scene: Scene) -> Strip | None:
    """The strip between corners (4,), which is measured once; None where nine tenths of it are hidden."""
    top, left, bottom, right = key = tuple(corners.tolist())
    if key not in scene.strips:
        cut = np.s_[top:bottom:2, left:right:2]
        depth = scene.merged.depth[cut]
        known = scene.merged.coloured[cut] & scene.visible[cut] & np.isfinite(depth)
        scene.strips[key] = (
            Strip(
                median_colour(scene.merged.colour[cut], known),
                float(np.median(depth[known])),
                float(scene.wall[cut][known].mean()),
            )
            if np.count_nonzero(known) >= 0.1 * max(known.size, 1)
            else None
        )
    return scene.strips[key]


def median_colour(colours: Image, known: Mask) -> NDArray[np.float64]:
    """(3,) median of the known colours, of 1: from a histogram, which is faster than to sort; at least one is known."""
    mask, count = known.view(np.uint8), np.count_nonzero(known)
    below = np.stack([cv2.calcHist([colours], [i], mask, [256], [0, 256]) for i in range(3)]).cumsum(axis=1)
    return (below[..., None] <= [(count - 1) // 2, count // 2]).sum(axis=1).mean(axis=1) / 255
