"""Frames that stand out of their wall, and that an outline took in with the leaf (ours, for section 6.2).

A frame of the leaf's own colour shows no edge of colour between the two; seen from the far side, not even the gap. But
it stands out of the leaf by the same step, and is as wide, on both sides and above, and the leaf goes on to the floor.
A panel of the leaf does not.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.orthoimage import column_medians
from detector.result import Candidate, Orthoimage, Rectangle

NARROWEST, WIDEST = 0.02, 0.15
"""Of frames [m]."""
UNEVEN = 0.03
"""The two sides and the head of a frame are as wide but for this [m]: seen aslant, its edges are blurred."""
STEP, DEEPEST = 0.005, 0.06
"""From a frame down to its leaf [m]; medians of hundreds of points are good to a tenth of the least step."""
FLAT = 0.003
"""Medians of the depth in one plane differ by less [m]."""
MOST = 0.75
"""Share of a strip's columns that lie in its plane; next to edges, some scans see past them."""
BLUR = 0.01
"""Next to an edge depths are a mixture of both its sides [m]."""
FOOT = 0.15
"""Above the floor, this much of the leaf must be as deep as its middle [m]; the bottom rail of a panel is higher."""


def leaves_in_frames(
    candidates: tuple[Candidate, ...], merged: Orthoimage, height: float
) -> tuple[tuple[Candidate, ...], tuple[Candidate, ...]]:
    """Cut those of the accepted candidates that took in a frame down to their leaf; what lies between is rejected.

    Args:
        height: Height of the wall [m].

    Returns:
        All candidates, and those of them that are such leaves.
    """
    leaves: list[Candidate] = []
    outlines: list[tuple[Rectangle, Rectangle]] = []
    for candidate in candidates:
        if candidate.rejected_by is None:
            leaf = without_frame(candidate.rectangle, merged, height)
            if leaf is not candidate.rectangle:
                leaves.append(replace(candidate, rectangle=leaf))
                outlines.append((candidate.rectangle, leaf))
    others = [
        replace(candidate, rejected_by="minimum size")
        if candidate.rejected_by is None and any(_between(candidate.rectangle, *pair) for pair in outlines)
        else candidate
        for candidate in candidates
    ]
    return (*leaves, *others), tuple(leaves)


def _between(rectangle: Rectangle, outer: Rectangle, inner: Rectangle) -> bool:
    """Whether a rectangle holds one rectangle and is held by another."""
    return (
        outer.left - BLUR < rectangle.left < inner.left + BLUR
        and inner.right - BLUR < rectangle.right < outer.right + BLUR
        and inner.top - BLUR < rectangle.top < outer.top + BLUR
    )


class _Strip(NamedTuple):
    """The part of a frame along one side."""

    width: float
    """[m]"""
    step: float
    """Down to the leaf [m]."""


def without_frame(rectangle: Rectangle, merged: Orthoimage, height: float) -> Rectangle:
    """The leaf's outline, where a closed door was found with its frame; else the rectangle itself.

    Args:
        rectangle: A closed door.
        height: Height of the wall [m].
    """
    px = merged.pixel_size
    left, right = (round(u / px) for u in (rectangle.left, rectangle.right))
    top, foot = (round((height - v) / px) for v in (rectangle.top, rectangle.bottom))
    depth, widest = merged.depth[top:foot, left:right], round(WIDEST / px)
    if min(depth.shape) <= 3 * widest:
        return rectangle
    leaf = depth[widest:, widest:-widest]
    low = leaf[-round(FOOT / px) : -round(BLUR / px)]
    level, foot_level = _median(leaf), _median(low)
    if not abs(level - foot_level) < FLAT:  # or nothing is seen of it
        return rectangle
    sides = [
        _strip(band, level, px)
        for band in (
            depth[widest:, : 2 * widest],
            depth[widest:, : -2 * widest : -1],
            depth[: 2 * widest, widest:-widest].T,
        )
    ]
    strips = [strip for strip in sides if strip is not None]
    if (
        len(strips) < len(sides)
        or _spread([s.width for s in strips]) > UNEVEN
        or _spread([s.step for s in strips]) > FLAT
    ):
        return rectangle
    west, east, head = (strip.width for strip in strips)
    return Rectangle(rectangle.left + west, rectangle.bottom, rectangle.right - east, rectangle.top - head)


def _strip(band: NDArray[np.float32], level: float, px: float) -> _Strip | None:
    """The strip of one depth that a band (M, N) begins with, if the leaf follows; columns go inwards from the side."""
    blur = round(BLUR / px)
    known = np.isfinite(band).any(axis=0)
    depths = np.full(band.shape[1], np.nan, np.float32)
    depths[known] = column_medians(band[:, known])
    face = _median(depths[blur : round(NARROWEST / px) + blur])
    if not STEP < face - level < DEEPEST:
        return None
    ends = np.flatnonzero(depths[blur:] < (face + level) / 2)
    if len(ends) == 0:
        return None
    end = blur + int(ends[0])
    frame, beyond = depths[blur : end - blur], depths[end + blur : end + 4 * blur]
    is_frame = NARROWEST <= end * px <= WIDEST and _is_level(frame, face)
    return _Strip(end * px, face - level) if is_frame and _is_level(beyond, level) else None


def _is_level(depths: NDArray[np.float32], depth: float) -> bool:
    """Whether columns of these depths lie in a plane of one depth."""
    return len(depths) > 0 and float(np.mean(np.abs(depths - depth) < FLAT)) >= MOST


def _median(values: NDArray[np.float32]) -> float:
    """Median of what is known; NaN if nothing is."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


def _spread(values: list[float]) -> float:
    return max(values) - min(values)
