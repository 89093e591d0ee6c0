"""Condition 4 of section 6.2: which of the rectangles that fulfil the others are the doors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from detector.result import Candidate, Rectangle

ALIKE = 0.045
"""Rectangles whose sides all lie this close are readings of the same door [m]."""
OTHER_LEAF = (0.4, 1.3)
"""Width of the second leaf of a double door [m]."""
MULLION = 0.1
"""What stands between the leaves of one double door is no wider than this [m]."""
WALL_SLACK = 0.03
"""A rectangle that adds more than this share of wall to a leaf adds no other leaf: alpha3."""
SET_SLACK = 0.12
"""A reading with this much less wall round it lies within the doorway."""
SUPPORT_SLACK = 0.06
"""Sums of support that differ by less do not tell which of two lines is the side."""
MOULDING = 0.25
"""Mouldings lie this close to the sides of their leaf [m]."""
FRAME = (0.02, 0.15)
"""Least and largest width of a frame [m]."""
UNEVEN = 0.04
"""The sides of a frame are as wide but for this [m]: lines lie at either border of what they are."""
SAME_LINE = 0.015
"""Clear and faint readings of one side differ by less than this [m]."""
DECORATION = 0.2
"""A rectangle whose weakest side has this much less support than that of the one round it is part of its decoration."""


def smallest(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Of nested rectangles that fulfil the other conditions, the smallest; all candidates, those that stand first.

    The paper heads this condition "Minimum size" but writes that r must not be contained in another rectangle, which
    would keep the outline of the frame instead of that of the leaf; the heading is followed. Rectangles a few pixels
    apart are readings of one door: of those the best supported one stands for all.
    """
    fulfilled = [c for c in candidates if c.rejected_by is None]
    wholes = [c for c in fulfilled if not _are_two_doors(c, fulfilled)]
    accepted = [
        c
        for c in fulfilled
        if not any(_is_leaf_of(c, whole) for whole in wholes) and not any(_decorates(c, o) for o in fulfilled)
    ]
    accepted.sort(key=lambda c: (c.rectangle.area, c.rectangle.left))
    kept: list[Candidate] = []
    taken: set[int] = set()
    for candidate in accepted:
        if any(covers(candidate, k) for k in kept):
            continue
        readings = [c for c in accepted if id(c) not in taken and _alike(c.rectangle, candidate.rectangle)]
        taken.update(id(c) for c in readings)
        kept.append(_best_reading(readings))
    kept.sort(key=lambda c: c.rectangle.left)
    losers = [replace(c, rejected_by="minimum size") for c in fulfilled if not any(c is k for k in kept)]
    return (*kept, *losers, *(c for c in candidates if c.rejected_by is not None))


def _alike(a: Rectangle, b: Rectangle) -> bool:
    """Whether all sides lie within a few centimetres."""
    return max(abs(a.left - b.left), abs(a.right - b.right), abs(a.top - b.top)) < ALIKE


def _best_reading(readings: Sequence[Candidate]) -> Candidate:
    """The smallest of those readings of one door that are set in wall and supported as well as any."""
    wall = max(c.surroundings for c in readings)
    readings = [c for c in readings if c.surroundings > wall - SET_SLACK]
    support = max(sum(c.side_support) for c in readings)
    return min((c for c in readings if sum(c.side_support) > support - SUPPORT_SLACK), key=lambda c: c.rectangle.area)


def _is_leaf_of(part: Candidate, all_of_it: Candidate) -> bool:
    """Whether one rectangle is half of another that is a double door: what is left of that is a leaf and no wall."""
    leaf, whole = part.rectangle, all_of_it.rectangle
    level = abs(leaf.top - whole.top) < ALIKE
    shared = abs(leaf.left - whole.left) < ALIKE or abs(leaf.right - whole.right) < ALIKE
    adds_wall = all_of_it.wall_share > part.wall_share + WALL_SLACK
    return level and shared and not adds_wall and OTHER_LEAF[0] <= whole.width - leaf.width <= OTHER_LEAF[1]


def _are_two_doors(hull: Candidate, fulfilled: Sequence[Candidate]) -> bool:
    """Whether a rectangle is but the hull of two doors that stand apart: leaves meet."""
    whole = hull.rectangle
    halves = [c.rectangle for c in fulfilled if _is_leaf_of(c, hull)]
    first = [h.right for h in halves if abs(h.left - whole.left) < ALIKE]
    second = [h.left for h in halves if abs(h.right - whole.right) < ALIKE]
    gaps = [b - a for a in first for b in second]
    return any(gap > MULLION for gap in gaps) and not any(abs(gap) < ALIKE for gap in gaps)


def _decorates(inner: Candidate, outer: Candidate) -> bool:
    """Whether a rectangle is made of the mouldings of another that has the better outline."""
    a, b = inner.rectangle, outer.rectangle
    margins = (a.left - b.left, b.right - a.right, b.top - a.top)
    nested = min(margins) > -ALIKE and ALIKE < max(margins) < MOULDING
    return nested and min(inner.side_support) < min(outer.side_support) - DECORATION


def frames(outer: Candidate, inner: Candidate) -> bool:
    """Whether one rectangle takes in the frame of another: all of it, as wide above as on both sides, or its head."""
    a, b = outer.rectangle, inner.rectangle
    sides, above = (b.left - a.left, a.right - b.right), a.top - b.top
    widths = (*sides, above)
    is_head = max(map(abs, sides)) < SAME_LINE and FRAME[0] < above < FRAME[1]
    return is_head or (FRAME[0] < min(widths) and max(widths) < FRAME[1] and max(widths) - min(widths) < UNEVEN)


def covers(a: Candidate, b: Candidate) -> bool:
    """Whether two rectangles claim the same piece of wall."""
    outer, inner = a.rectangle, b.rectangle
    width = min(outer.right, inner.right) - max(outer.left, inner.left)
    height = min(outer.top, inner.top) - max(outer.bottom, inner.bottom)
    return width > 0 and height > 0 and width * height > 0.3 * min(outer.area, inner.area)
