"""Rectangles of door size that stand on the floor, and what each condition of section 6.2 measures on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.edges import COLOUR_ALONG, Edges
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.rectangles import CLEAR_SHARE, LEAST_VISIBLE, box_sums, integral, pairs
from detector.result import Image, Mask, Orthoimage

FOOT = 0.3
"""The sides of a door reach the floor; those of a panel in it do not: tested over this height [m]."""
FOOT_SUPPORT = 0.4
END_VISIBLE = 0.3
"""Least visible share of a foot or corner that can refute a side."""
CORNER = 0.06
"""The top of a door reaches its corners; that of a panel in it does not: tested over this width [m]."""
CORNER_SUPPORT = 0.4
VISIBLE_SHARE = 0.4
"""Share of a side over which it is visible that is enough to judge it."""
STRIP = (0.01, 0.06)
"""What surrounds a door is looked at from here to there outside its sides [m]."""
OVERSHOOT = 0.15
"""How far beyond its corners the outline of a door must have ended [m]."""
MAX_OVERSHOOT = 0.5
"""A level line that is seen over less than this share of such a length ends."""
PATTERN = 2
"""Fewer level lines than this, one above the other, are no pattern."""
GO_ON = 1 / 3
"""Share of a pattern that may go on within a door that interrupts it: a handle lies in line with a joint."""
IN_LINE_PX = 2
"""Level lines on both sides that are this close are one: each wanders by a pixel."""


class Strip(NamedTuple):
    """What is seen of the wall on a strip."""

    colour: NDArray[np.float64]
    """(3,) median, of 1."""
    depth: float
    """Median [m]."""
    wall: float
    """Share of it that is wall area."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The images that candidates are judged on. What it keeps of them, candidates share."""

    merged: Orthoimage
    seen: Image
    edges: Edges
    wall: Mask
    face: Mask
    """(H, W) where some view shows the wall's face, or what lies flat on it."""
    visible: Mask
    """(H, W) where nothing hides the wall's plane: data, or looked through."""
    hidden: Mask
    """(H, W) `occluders`."""
    floor_row: int
    """First row below the floor."""
    lowest_row: int
    """First row that may hold points of the floor instead of the wall."""
    protrusion: float
    """What is nearer than this to the room is not in the doorway [m]."""
    strips: dict[tuple[int, ...], Strip | None] = field(default_factory=dict)
    """Strips along the sides of candidates that were measured already, by their corners: candidates share lines."""
    hanging: dict[tuple[int, int], bool] = field(default_factory=dict)
    """Whether what is between two columns hangs on the wall, where that was asked already."""

    def sums(self, mask: Mask) -> NDArray[np.int32]:
        """Integral image of a mask, above the floor's points."""
        sums = integral(mask)
        sums[self.lowest_row + 1 :] = sums[self.lowest_row]
        return sums


@dataclass(frozen=True, eq=False)
class Boxes:
    """N rectangles between lines: positions [px], whole numbers are pixel centres."""

    left: NDArray[np.float64]
    right: NDArray[np.float64]
    top: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.left)

    def __getitem__(self, chosen: NDArray) -> Boxes:
        return Boxes(self.left[chosen], self.right[chosen], self.top[chosen])


def door_boxes(
    vertical: NDArray[np.float64], horizontal: NDArray[np.float64], scene: Scene, parameters: DetectorParameters
) -> Boxes:
    """All rectangles of door size between the lines, standing on the floor."""
    px = scene.merged.pixel_size
    sides = pairs(vertical, parameters.min_width / px, parameters.max_width / px)
    height = (scene.floor_row - 0.5 - horizontal) * px
    tops = horizontal[(height >= parameters.min_height) & (height <= parameters.max_height)]
    side, top = np.meshgrid(np.arange(len(sides)), np.arange(len(tops)), indexing="ij")
    chosen = sides[side.ravel()]
    return Boxes(vertical[chosen[:, 0]], vertical[chosen[:, 1]], tops[top.ravel()])


def side_support(boxes: Boxes, scene: Scene) -> tuple[NDArray, NDArray]:
    """Condition 2: share of the left, top, right and bottom sides on a discontinuity, (N, 4).

    Shares are of the visible length; what furniture hides can neither support nor refute. Where most of a side is
    hidden, the rest must be clear. The bottom is the floor.

    Returns:
        The support, and the same of the left and right foot, (N, 2).
    """
    foot = max(1, round(FOOT / scene.merged.pixel_size))
    top, left, right = (np.rint(x).astype(int) for x in (boxes.top, boxes.left, boxes.right))
    lowest = np.full(len(boxes), scene.lowest_row)
    upright = _edges_and_view(scene.edges.upright, scene, (1, 3))
    level = _edges_and_view(scene.edges.level, scene, (3, 1))
    sides = [_shares(*upright, [top, x, lowest, x + 1]) for x in (left, right)]
    above = _shares(*level, [top, left, top + 1, right + 1])
    feet = [_shares(*upright, [lowest - foot, x, lowest, x + 1]) for x in (left, right)]
    supports = [_support(*sides[0]), _support(*above), _support(*sides[1]), np.ones(len(boxes))]
    return np.stack(supports, axis=1), _end_support(feet)


def corner_support(boxes: Boxes, scene: Scene) -> NDArray[np.float64]:
    """(N, 2) share of the left and the right end of the top on a discontinuity; 1 where too little of it is visible.

    Smoothed along, an edge has half of its change at its end. That will do there, if the edge is whole next to it.
    """
    corner, smoothed = (max(1, round(x / scene.merged.pixel_size)) for x in (CORNER, COLOUR_ALONG))
    top, left, right = (np.rint(x).astype(int) for x in (boxes.top, boxes.left, boxes.right))

    def ends(edges: Mask, first: int, last: int) -> NDArray[np.float64]:
        level = _edges_and_view(edges, scene, (3, 1))
        spans = (left + first, left + last + 1), (right - last, right - first + 1)
        return _end_support([_shares(*level, [top, a, top + 1, b]) for a, b in spans])

    whole, half = (ends(edges, 0, corner) for edges in (scene.edges.level, scene.edges.level_ends))
    return np.maximum(whole, np.minimum(half, ends(scene.edges.level, smoothed // 2, smoothed)))


def _edges_and_view(edges: Mask, scene: Scene, across: tuple[int, int]) -> tuple[NDArray, NDArray]:
    """Integral images of the edges and of what is visible, both a pixel wider across the sides."""
    shape = np.ones(across, np.uint8)
    hits, visible = (scene.sums(cv2.dilate(mask.view(np.uint8), shape) > 0) for mask in (edges, scene.visible))
    return hits, visible


def _end_support(shares: Sequence[tuple[NDArray, NDArray]]) -> NDArray:
    """(N, 2) shares of both ends; 1 where too little of one is visible."""
    return np.stack([np.where(seen >= END_VISIBLE, share, 1.0) for share, seen in shares], axis=1)


def _shares(hits: NDArray, visible: NDArray, spans: Sequence[NDArray]) -> tuple[NDArray, NDArray]:
    """Hits per visible pixel of each span from top, left to bottom, right, and the share of it that is visible."""
    boxes = np.stack(spans, axis=1)
    seen = box_sums(visible, boxes)
    return np.minimum(box_sums(hits, boxes) / np.maximum(seen, 1), 1.0), seen / _area(boxes)


def _support(shares: NDArray, visible: NDArray) -> NDArray:
    """Support of sides: their shares, 0 where too little of them is visible."""
    clear = (visible >= LEAST_VISIBLE) & (shares >= CLEAR_SHARE)
    return np.where((visible >= VISIBLE_SHARE) | clear, shares, 0.0)


def inner_shares(boxes: Boxes, scene: Scene) -> tuple[NDArray, NDArray, NDArray]:
    """Shares (N,) of each rectangle that are wall area (condition 3), visible, and looked through."""
    box = np.stack(
        [
            np.ceil(boxes.top + 0.5),
            np.ceil(boxes.left + 0.5),
            np.full(len(boxes), scene.lowest_row),
            np.floor(boxes.right + 0.5),
        ],
        axis=1,
    ).astype(np.int64)
    area = _area(box)
    through = scene.seen == Visibility.THROUGH
    masks = (scene.wall, scene.visible, through)
    wall, visible, passed = (box_sums(scene.sums(mask), box) / area for mask in masks)
    return wall, visible, passed


def surroundings(boxes: Boxes, scene: Scene) -> NDArray[np.float64]:
    """(N, 3) share of the visible strips outside the left, top and right sides that lies in the wall's plane.

    A rectangle inside an open doorway, between the jamb and the edge of the leaf, has no wall on one side. Where the
    strip is hidden or beyond the image: 1, but 0 where something that stands out into the room hides it from within.
    """
    plane = scene.sums(scene.face)
    visible = scene.sums(scene.visible)
    standing_out = scene.sums((np.nan_to_num(scene.merged.depth, nan=-np.inf) > scene.protrusion) & scene.visible)
    result = np.ones((len(boxes), 3))
    sides = zip(strips(boxes, scene, outside=True), strips(boxes, scene, outside=False), strict=True)
    for i, (outer, inner) in enumerate(sides):
        seen = box_sums(visible, outer)
        share = np.minimum(box_sums(plane, outer) / np.maximum(seen, 1), 1.0)
        hidden_by_leaf = box_sums(standing_out, inner) > 0.5 * _area(inner)
        result[:, i] = np.where(seen > 0.2 * _area(outer), share, np.where(hidden_by_leaf, 0.0, 1.0))
    return result


def _area(boxes: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N,) pixels of boxes (N, 4), at least one."""
    return np.maximum((boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1]), 1)


def strips(boxes: Boxes, scene: Scene, *, outside: bool) -> list[NDArray[np.int64]]:
    """Boxes (N, 4) of the strips along the left, top and right sides: top, left, bottom, right, half open."""
    near, far = (np.rint(x / scene.merged.pixel_size) for x in STRIP)
    sign = 1 if outside else -1
    left, right, top = boxes.left + 0.5, boxes.right + 0.5, boxes.top + 0.5
    low = np.full(len(boxes), scene.lowest_row, float)
    spans = [np.sort(np.stack([x - sign * near, x - sign * far]), axis=0) for x in (left, top)]
    spans.append(np.sort(np.stack([right + sign * near, right + sign * far]), axis=0))
    result = [
        np.stack([top, spans[0][0], low, spans[0][1]], axis=1),
        np.stack([spans[1][0], left, spans[1][1], right], axis=1),
        np.stack([top, spans[2][0], low, spans[2][1]], axis=1),
    ]
    limit = np.array([*scene.seen.shape, *scene.seen.shape])
    return [np.clip(np.rint(r), 0, limit).astype(np.int64) for r in result]


def overshoot(boxes: Boxes, scene: Scene) -> NDArray[np.float64]:
    """(N,) larger share of edges where the top is drawn out beyond its corners; 1 where this cannot be seen.

    The joints of tiles go on there, if faintly, and planks have none; the head of a door ends. At the end of the wall
    everything does.
    """
    top, worst = np.rint(boxes.top).astype(int), np.zeros(len(boxes))
    for sides, outwards in ((boxes.left, -1), (boxes.right, 1)):
        columns, line = np.unique(np.rint(sides).astype(int), return_inverse=True)
        beyond = np.nan_to_num(_level_shares(columns, outwards, scene), nan=1.0)
        worst = np.maximum(worst, beyond[line, top])
    return worst


def interrupts(boxes: Boxes, scene: Scene) -> NDArray[np.bool_]:
    """(N,) whether a pattern of level lines goes on from the left of a rectangle to its right, but not within it.

    The head of a door may lie in line with a joint of the tiles around it, but the joints below end at its sides, to
    begin again in line beyond it. Joints of planks are staggered. A skirting does not count: it ends anywhere.
    """
    if len(boxes) == 0:
        return np.zeros(0, bool)
    sides = np.rint(np.stack([boxes.left, boxes.right], axis=1)).astype(int)
    (left, right), pair = (x.T for x in np.unique(sides, axis=0, return_inverse=True))
    outside, inside = ((_level_shares(left, way, scene), _level_shares(right, -way, scene)) for way in (-1, 1))
    lines = np.isfinite(inside).all(axis=0) & np.all([_in_line(share) for share in outside], axis=0)
    lines[:, max(0, scene.lowest_row - round(FOOT / scene.merged.pixel_size)) :] = False
    begins = lines & ~np.pad(lines, ((0, 0), (1, 0)))[:, :-1]
    going_on = begins & np.any([_in_line(share) for share in inside], axis=0)
    count, crossing = (np.cumsum(mask[:, ::-1], axis=1)[:, ::-1] for mask in (begins, going_on))  # from a row down
    interrupted = (count >= PATTERN) & (crossing < GO_ON * count)
    below = np.rint(boxes.top).astype(int) + _blur(scene)
    return np.asarray(interrupted[pair.ravel(), np.minimum(below, lines.shape[1] - 1)])


def _in_line(share: NDArray[np.float64]) -> Mask:
    """(N, H) rows in line with a level line, of which the shares (N, H) are seen."""
    line = (share >= MAX_OVERSHOOT).astype(np.uint8)
    return cv2.dilate(line, np.ones((1, IN_LINE_PX + 1), np.uint8)) > 0


def _blur(scene: Scene) -> int:
    """So far an edge is smoothed beyond its end [px]."""
    return 1 + round(COLOUR_ALONG / 2 / scene.merged.pixel_size)


def _level_shares(columns: NDArray[np.int64], way: int, scene: Scene) -> NDArray[np.float64]:
    """(N, H) share of faint level edges in each row to the left (way -1) or right (1) of columns; NaN where unseen."""
    level = scene.sums(cv2.dilate(scene.edges.faint_level.view(np.uint8), np.ones((3, 1), np.uint8)) > 0)
    reach = round(OVERSHOOT / scene.merged.pixel_size)
    ends = np.sort([columns + way * _blur(scene), columns + way * (_blur(scene) + reach)], axis=0)
    first, last = np.clip(ends, 0, scene.visible.shape[1])
    hits, seen = (np.diff(sums[:, last] - sums[:, first], axis=0).T for sums in (level, scene.sums(scene.visible)))
    return np.where(seen >= END_VISIBLE * reach, hits / np.maximum(seen, 1), np.nan)
