"""From a doorway to a door: its kind, its leaves and their state (sections 6 and 6.3)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from detector.angle import closed_depth, fit_leaf
from detector.parameters import DetectorParameters
from detector.result import Door, Image, Leaf, Orthoimage, Rectangle
from detector.sliding import find_slide

MAX_LEAF = 1.3
"""Widest single leaf [m]; wider doorways have two."""
RIGHT_ANGLE = np.deg2rad(90.0)
NO_POINTS = np.zeros((0, 2), np.float32)


def describe_door(
    doorway: Rectangle,
    merged: Orthoimage,
    seen: Image,
    points: NDArray[np.float32],
    height: float,
    parameters: DetectorParameters,
) -> Door:
    """Kind, state and leaves of the door in a doorway.

    An open doorway in which no leaf was seen keeps one leaf with an angle of NaN, and counts as open. So does one whose
    leaf is flat on the wall beside it: it may have slid or turned.

    Args:
        doorway: The door's outline; of a leaf that has slid along the face of the wall, with the leaf.
        points: (N, 3) points round the doorway in wall coordinates [m].
        height: Height of the wall [m].
    """
    missing = Leaf("none", float("nan"), float("nan"), None, NO_POINTS)
    slide = find_slide(doorway, merged, seen, points, height)
    if slide is not None:
        if slide.is_beside:
            return Door(slide.doorway, "single", "open", (missing,))
        if not _open_leaf(_double(slide.doorway, merged, points, height, parameters)):
            return Door(slide.doorway, "sliding", "semi-open", (closed_leaf(slide.way),))
    if closed_depth(doorway, merged, height, parameters) is not None:
        if doorway.width > MAX_LEAF:
            return Door(doorway, "double", "closed", (closed_leaf(), closed_leaf()))
        return Door(doorway, "single", "closed", (closed_leaf(),))
    left, right = (fit_leaf(points, doorway, side, parameters) for side in ("left", "right"))
    single = max((fit for fit in (left, right) if fit is not None), key=lambda fit: fit.likelihood, default=None)
    double = _double(doorway, merged, points, height, parameters)
    if double is not None and (doorway.width > MAX_LEAF or single is None):
        return Door(doorway, "double", _state(double), double)
    if single is not None:
        leaf = _closed_if_shut(single.leaf, parameters)
        return Door(doorway, "single", _state((leaf,)), (leaf,))
    return Door(doorway, "single", "open", (missing,))


def closed_leaf(slid: float = 0.0) -> Leaf:
    """A leaf parallel to the wall, at its closed place or slid along u [m]."""
    return Leaf("none", 0.0, 0.0, None, NO_POINTS, slid)


def _closed_if_shut(leaf: Leaf, parameters: DetectorParameters) -> Leaf:
    """A leaf below the closed angle is closed, whatever its pane lets through."""
    return closed_leaf() if leaf.opening_angle < parameters.closed_angle else leaf


def join_leaves(doors: list[Door]) -> list[Door]:
    """Neighbouring doors of one height that share a side, as one double door; doors from left to right.

    The confidence of a double door is that of the less sure half.
    """
    result: list[Door] = []
    for door in doors:
        before = result[-1] if result else None
        if before is not None and _is_pair(before, door):
            a, b = before.rectangle, door.rectangle
            whole = Rectangle(a.left, min(a.bottom, b.bottom), b.right, (a.top + b.top) / 2)
            leaves = (*before.leaves, *door.leaves)
            weaker = min((before, door), key=lambda half: half.confidence)
            result[-1] = Door(whole, "double", _state(leaves), leaves, weaker.confidence, weaker.evidence)
        else:
            result.append(door)
    return result


def _is_pair(a: Door, b: Door) -> bool:
    """Whether two doors are the leaves of one."""
    gap = b.rectangle.left - a.rectangle.right
    level = abs(a.rectangle.top - b.rectangle.top) < 0.03
    return abs(gap) < 0.04 and level and a.kind == b.kind == "single"


def _open_leaf(leaves: tuple[Leaf, ...] | None) -> bool:
    """Whether there is a leaf that has turned."""
    return leaves is not None and any(leaf.opening_angle > 0 for leaf in leaves)


def _double(
    doorway: Rectangle, merged: Orthoimage, points: NDArray, height: float, parameters: DetectorParameters
) -> tuple[Leaf, Leaf] | None:
    """Two leaves that meet in the middle, one of which may be closed."""
    if doorway.width < 2 * parameters.min_width:
        return None
    middle = (doorway.left + doorway.right) / 2
    leaves: list[Leaf] = []
    sides: tuple[Literal["left", "right"], ...] = ("left", "right")
    for side in sides:
        low, high = (doorway.left, middle) if side == "left" else (middle, doorway.right)
        half = Rectangle(low, doorway.bottom, high, doorway.top)
        if closed_depth(half, merged, height, parameters) is not None:
            leaves.append(closed_leaf())
            continue
        fit = fit_leaf(points, half, side, parameters)
        if fit is None:
            return None
        leaves.append(_closed_if_shut(fit.leaf, parameters))
    return leaves[0], leaves[1]


def _state(leaves: tuple[Leaf, ...]) -> Literal["closed", "semi-open", "open"]:
    """State by the widest leaf (section 6)."""
    widest = max(leaf.opening_angle for leaf in leaves)
    if widest == 0:
        return "closed"
    return "open" if widest >= RIGHT_ANGLE else "semi-open"
