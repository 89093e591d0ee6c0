"""Doors that slide (section 6.3, figure 11): a leaf parallel to the wall fills one side of the hole, the other is open.

Such a leaf runs before the wall's face, behind it, or in a pocket in the wall. The first kind is seen as a whole,
partly beside its hole; of the others the hole shows what has not yet slid out of sight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from detector.openings import Visibility
from detector.orthoimage import column_medians
from detector.result import Image, Orthoimage, Rectangle

NEAR_EDGE = 0.1
"""The ends of the columns, near floor and lintel, are left out [m]."""
OF_ONE_KIND = 0.7
"""Share of a column that is leaf, or is looked through, of what is visible of it."""
VISIBLE = 0.3
"""Least share of a column that must be visible."""
CONTIGUOUS = 0.9
"""Share of the columns on each side of the leaf's edge that are of its kind."""
LEAST_LEAF = 0.1
"""A narrower plane in the hole is a frame or a stop [m]."""
LEAST_GAP = 0.04
"""A narrower opening is the joint between leaf and frame [m]."""
STILE = 0.04
"""Beside a pane of glass there is at least this much of the leaf [m]; beside an opening there is nothing."""
FLAT = 0.03
"""From one end of it to the other, a leaf that slides comes nearer by less than this [m]: one that turned, by 0.4 m."""
BESIDE_WALL = 0.02
"""A leaf whose face is closer to the wall's has the wall itself in its way [m]."""
SAME_PLANE = 0.01
"""Points of a leaf's face lie this close to its depth, those of its edges do not [m]: three sigma."""
MAX_COVER = 0.1
"""A leaf covers the wall round its hole by no more than this [m]."""
END = 0.05
"""The density of a leaf's points is measured over this length from its edge, and its end looked for as far [m]."""
LEAST_POINTS = 30
"""Fewer points over that length say nothing."""
ALL_OPEN = 0.95
"""A leaf before the wall that leaves more than this share of its width open may as well be hinged and folded back."""


@dataclass(frozen=True)
class Slide:
    """A leaf beside its closed place."""

    doorway: Rectangle
    """What the leaf fills when it is closed; of a leaf that stands quite beside the hole, the hole."""
    way: float
    """How far along u the leaf has slid [m], negative to the left."""

    @property
    def is_beside(self) -> bool:
        """Whether the whole hole is open."""
        return abs(self.way) >= ALL_OPEN * self.doorway.width


def find_slide(
    outline: Rectangle, merged: Orthoimage, seen: Image, points: NDArray[np.float32], height: float
) -> Slide | None:
    """The slid leaf within an outline that encloses the hole, and the leaf, too, if that runs before the wall.

    Args:
        seen: (H, W) `Visibility`.
        points: (N, 3) points round the outline in wall coordinates [m].
        height: Height of the wall [m].
    """
    px = merged.pixel_size
    rows = slice(*(max(int((height - v) / px), 0) for v in (outline.top - NEAR_EDGE, outline.bottom + NEAR_EDGE)))
    first, last = (round(u / px) for u in (outline.left, outline.right))
    band = np.s_[rows, max(first, 0) : last]
    for to_right in (False, True):
        turn = np.s_[:, ::-1] if to_right else np.s_[:, :]  # as if the leaf stood on the left of the opening
        edge = _free_edge(seen[band][turn], px)
        if edge is None:
            continue
        plane = _plane(merged.depth[band][turn][:, :edge], px)
        if plane is None:
            continue
        place = outline.right - edge * px if to_right else outline.left + edge * px
        if plane > 0:
            above = np.s_[max(int((height - outline.top - END) / px), 0) : rows.stop, max(first, 0) : last]
            rows_above = _rows_of_wall(merged.depth[above][turn][:, edge:], seen[above][turn][:, edge:])
            hole_top = height - (above[0].start + rows_above) * px
            return _before_wall(outline, place, hole_top, to_right, _face(points, outline, plane))
        gap = place - outline.left if to_right else outline.right - place
        return Slide(outline, gap if to_right else -gap)
    return None


def _free_edge(seen: Image, px: float) -> int | None:
    """Column at which a leaf on the left ends and an opening begins that reaches the right side, if it is so."""
    data, through = seen == Visibility.DATA, seen == Visibility.THROUGH
    visible = np.maximum((data | through).sum(axis=0), VISIBLE * len(seen))
    is_leaf, is_open = data.sum(axis=0) >= OF_ONE_KIND * visible, through.sum(axis=0) >= OF_ONE_KIND * visible
    agreeing = np.append(0, np.cumsum(is_leaf)) + np.append(np.cumsum(is_open[::-1])[::-1], 0)
    edge = int(agreeing.argmax())
    gap = is_open[edge:]
    if edge * px < LEAST_LEAF or len(gap) * px < LEAST_GAP:
        return None
    if min(is_leaf[:edge].mean(), gap.mean()) < CONTIGUOUS or gap[-max(2, round(STILE / px)) :].mean() < 0.5:
        return None
    return edge


def _rows_of_wall(depth: NDArray[np.float32], seen: Image) -> int:
    """Rows (H, W) above a hole; the soffit in it lies deeper than the wall's face and is seen at a slant."""
    hole = ((seen == Visibility.THROUGH) | (depth <= -BESIDE_WALL)).mean(axis=1) > 0.5
    return int(hole.argmax()) if hole.any() else len(hole)


def _plane(depth: NDArray[np.float32], px: float) -> float | None:
    """Depth of the plane beside the wall's that a leaf's columns (H, W) show [m]; None if they show none."""
    columns = np.flatnonzero(np.isfinite(depth).mean(axis=0) > VISIBLE)
    margin = max(1, len(columns) // 10)  # its edges are seen against what lies behind
    columns = columns[margin:-margin]
    if len(columns) < 3:
        return None
    medians = column_medians(depth[:, columns])
    middle = float(np.median(medians))
    flat = np.abs(medians - middle) < FLAT / 2
    return middle if flat.mean() >= CONTIGUOUS and abs(middle) > BESIDE_WALL else None


def _face(points: NDArray[np.float32], outline: Rectangle, plane: float) -> NDArray[np.float32]:
    """(N, 2) along u and v of the points at a leaf's depth, near its outline [m]."""
    u, v, depth = points.T
    near = (np.abs(depth - plane) < min(SAME_PLANE, plane / 2)) & (v > outline.bottom + NEAR_EDGE)
    near &= (u > outline.left - END) & (u < outline.right + END) & (v < outline.top + END)
    return points[near, :2]


def _before_wall(outline: Rectangle, place: float, hole_top: float, to_right: bool, face: NDArray[np.float32]) -> Slide:
    """The slide of a leaf that is seen as a whole: closed, it covers the hole, by as much at the far side as above.

    Args:
        place: Of the leaf's free edge along u [m].
        hole_top: Height of the hole [m].
        face: (N, 2) points of the leaf's face along u and v [m].
    """
    below = face[face[:, 1] < outline.top - NEAR_EDGE, 0]
    if to_right:
        left, right = -_end(-below, -place), _end(below, outline.right)
    else:
        left, right = -_end(-below, -outline.left), _end(below, place)
    top = _end(face[(face[:, 0] > left) & (face[:, 0] < right), 1], outline.top)
    gap = left - outline.left if to_right else outline.right - right
    is_beside = gap >= ALL_OPEN * (right - left)
    width = gap if is_beside else right - left
    cover = 0.0 if is_beside else float(np.clip(top - hole_top, 0, MAX_COVER))
    gap += cover
    start, end = outline.left - cover, outline.right + cover
    sides = (start, start + width) if to_right else (end - width, end)
    return Slide(Rectangle(sides[0], outline.bottom, sides[1], top), gap if to_right else -gap)


def _end(values: NDArray[np.float32], about: float) -> float:
    """Where points (N,) end, near a place [m]: evenly spread up to there, they would be as many.

    Unlike the outermost point, that is the mean over views whose poses differ by their errors.
    """
    inner = about - END / 2
    before = int(((values > inner - END) & (values <= inner)).sum())
    beyond = int(((values > inner) & (values < about + END)).sum())
    return inner + END * beyond / before if before >= LEAST_POINTS else about
