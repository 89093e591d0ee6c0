"""The doorway's sides to the pixel, once it is known what stands in it (ours)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.angle import closed_depth
from detector.candidates import Scene
from detector.orthoimage import column_medians
from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage, Rectangle
from detector.subpixel import components, edge_centre

REACH = 0.05
"""How far from the found line the edge of the hole is looked for [m]."""
ABSENT = 0.7
"""Share of a side's length over which the wall's face must be missing inside a hole, and present outside."""
CLEAR = 0.1
"""Corners that are left out of the profiles [m]."""
FRAME = 0.12
"""Widest frame that an outline may have taken in [m]."""
BEHIND_FRAME = 0.03
"""Nothing of the wall's face is seen over this width inside a frame [m]."""
ONE_FACE = 0.015
"""Depths of a frame's face differ by less [m]: five sigma."""
STANDS_OUT = 0.03
"""A frame's face lies this close to the wall's [m]; a leaf that is nearer to the room is none."""
OPEN_SHARE = 0.5
"""A doorway in which less than this share is in the wall's face has an open or a recessed leaf."""
SHALLOW = 0.06
"""A leaf less deep than this is seen up to its edges [m]."""
HALF_GAP = 0.0015
"""From the middle of the gap between leaf and frame to the leaf [m]; the gap is 2 to 4 mm (DIN 18101)."""
BORDER_PX = 3
"""Pixels next to the edge that must be hole on one side and face on the other."""
REVEAL_PX = 3
"""So many pixels between them may be neither: beams on the reveal just behind the face."""
NEITHER = 0.5
"""A pixel is neither where less than this share of it is one of them."""


def settle_sides(
    rectangles: tuple[Rectangle, ...], passed: Mask, scene: Scene, height: float, parameters: DetectorParameters
) -> tuple[Rectangle, ...]:
    """Sides moved to the border between the wall's face and the hole in it, or else to the edge's own centre.

    Door stops and the far edge of the reveal make lines within the doorway; a leaf that is open or deep in the reveal
    fills, once closed, the whole hole. A leaf flush with the wall has no hole, and keeps its own outline.

    Args:
        passed: (H, W) where beams crossed the wall's face.
        height: Height of the wall [m].
    """
    if not parameters.settle_sides or not rectangles:
        return rectangles
    face, values = scene.face & ~passed, components(scene.merged, parameters)
    nothing = np.zeros_like(passed)
    return tuple(
        _settled(
            r,
            nothing if _is_shallow(r, scene.merged, height, parameters) else passed,
            face,
            values,
            scene.merged,
            height,
        )
        for r in rectangles
    )


def _is_shallow(rectangle: Rectangle, merged: Orthoimage, height: float, parameters: DetectorParameters) -> bool:
    """Whether a closed leaf little behind the wall's face fills a doorway: it shows its own edges.

    Beams to such a leaf cross the face's plane within its outline, the lower the deeper it is.
    """
    depth = closed_depth(rectangle, merged, height, parameters)
    return depth is not None and abs(depth) < SHALLOW


def _settled(
    rectangle: Rectangle,
    passed: Mask,
    face: Mask,
    values: NDArray[np.float32],
    merged: Orthoimage,
    height: float,
) -> Rectangle:
    """One rectangle with its left, right and top side settled.

    Args:
        values: (H, W, 4) from `components`.
    """
    pixel_size = merged.pixel_size
    rows = np.s_[
        int((height - rectangle.top + CLEAR) / pixel_size) : int((height - rectangle.bottom - CLEAR) / pixel_size)
    ]
    columns = np.s_[int((rectangle.left + CLEAR) / pixel_size) : int((rectangle.right - CLEAR) / pixel_size)]
    hole, wall = (m[rows].mean(axis=0) for m in (passed, face))
    reach, count = round(REACH / pixel_size), len(hole)
    sides = rectangle.left / pixel_size, rectangle.right / pixel_size, (height - rectangle.top) / pixel_size
    centres = [
        edge_centre(band, axis, side, pixel_size)
        for band, axis, side in zip((values[rows], values[rows], values[:, columns]), (1, 1, 0), sides, strict=True)
    ]
    frame = round(FRAME / pixel_size) if face[rows, columns].mean() < OPEN_SHARE else 0
    inside = max(1, round(BEHIND_FRAME / pixel_size))
    depth = merged.depth[rows]
    left = _without_frame(wall, depth, _edge(hole, wall, sides[0], reach, centres[0]), frame, inside)
    right = _edge(hole[::-1], wall[::-1], count - sides[1], reach, count - centres[1])
    right = count - _without_frame(wall[::-1], depth[:, ::-1], right, frame, inside)
    hole, wall = (m[:, columns].mean(axis=1) for m in (passed, face))
    top = _edge(hole, wall, sides[2], reach, centres[2])
    top = _without_frame(wall, merged.depth[:, columns].T, top, frame, inside)
    return Rectangle(
        left * pixel_size + HALF_GAP,
        rectangle.bottom,
        right * pixel_size - HALF_GAP,
        height - top * pixel_size - HALF_GAP,
    )


def _edge(hole: NDArray, face: NDArray, position: float, reach: int, otherwise: float) -> float:
    """First border where the face ends and the hole begins, near a position; `otherwise` if there is none.

    Args:
        hole, face: Share of each column or row that is looked through, and that is wall; the hole at higher indices.
        position: Where the line is, in borders of pixels.
        reach: How far to look [px].
    """
    borders = range(max(BORDER_PX, round(position) - reach), min(len(hole) - BORDER_PX, round(position) + reach + 1))
    for border in borders:
        if hole[border : border + BORDER_PX].min() < ABSENT:
            continue
        for end in range(border - 1, max(border - 2 - REVEAL_PX, BORDER_PX - 1), -1):
            if face[end - BORDER_PX : end].min() < ABSENT:
                continue
            # the face is sure up to `end`
            if (hole[end:border] + face[end:border]).max() < NEITHER:  # beams met the reveal; the face ends before it
                return float(end - 0.5 + face[end:border].sum())
            if end == border - 1:
                # a beam passed somewhere in the outermost pixel; before it, one may be hole in part of the rows
                return border + 0.5 - float(hole[end])
            break
    return otherwise


def _medians(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Median of each column; NaN where there is no data."""
    result = np.full(depth.shape[1], np.nan, np.float32)
    known = np.isfinite(depth).any(axis=0)
    if known.any():
        result[known] = column_medians(depth[:, known])
    return result


def _without_frame(face: NDArray, depth: NDArray, position: float, widest: int, inside: int) -> float:
    """Where the face that goes on inwards from a position ends; the position itself if it does not go on or not end.

    Args:
        face: Share of each column or row that is the wall's face; the doorway at higher indices.
        depth: (M, N) likewise in columns [m]; a leaf seen at a grazing angle is face in steps, but not of one depth.
        position: Where the side was found, in borders of pixels.
        widest: How far the face may go on [px].
        inside: Over how many pixels it must be absent beyond its end.
    """
    first = max(round(position) + 1, 0)  # the pixel on the border may be of either kind
    absent = np.flatnonzero(face[first : first + widest] < ABSENT)
    if len(absent) == 0 or absent[0] < BORDER_PX:
        return position
    end = first + int(absent[0])
    beyond = face[end + 1 : end + 1 + inside]
    frame = _medians(depth[:, first : end - 1])
    is_frame = np.ptp(frame) < ONE_FACE and np.abs(frame).max() < STANDS_OUT  # False for NaN
    return float(end) if is_frame and len(beyond) == inside and beyond.max() < 1 - ABSENT else position
