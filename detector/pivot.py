"""The hinge side of a door that stands wide open into the room (ours, after section 6.3).

The edge of such a leaf stands in the plane of the wall, beside its frame and often like it, so that the doorway's image
does not tell where the frame ends. The leaf itself does: its back, the side that shows when the door is closed, meets
the plane of the wall at the hinge.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from detector.angle import total_least_squares
from detector.result import Leaf, Rectangle

LEAST_ANGLE, LARGEST_ANGLE = np.deg2rad(85.0), np.deg2rad(115.0)
"""Below, the leaf's edge lies well behind the wall's face; above, a hinge 1 cm behind it moves the side by 5 mm."""
THICKNESS = (0.032, 0.052)
"""Of the leaves of inner doors, with the noise of two faces [m]: what is farther from a face is a wall beside it."""
USUAL_THICKNESS = 0.04
"""Of inner doors, 39 to 42 mm [m]."""
BIN = 0.005
"""Of the distances from the leaf's face, and of radii [m]."""
SAME_SIDE = 0.012
"""A side that lies nearer to a face of the leaf lies at it [m]."""
WELL_BESIDE = 0.1
"""Somebody nearer to the leaf's plane sees neither face well [m]."""
FIRST_RADIUS = 0.1
"""Points nearer to the hinge may be of the frame [m]."""
PIECE, SEEN = 0.05, 0.35
"""Length of the pieces of a leaf [m], and the least part of them in which its other face was seen if it was at all."""
FEW = 3
"""A piece with fewer points was not seen."""


def hinge_side(
    doorway: Rectangle,
    leaf: Leaf,
    points: NDArray[np.float32],
    cameras: Sequence[NDArray[np.float64]],
) -> Rectangle:
    """The doorway with its hinge side where the leaf's back meets the wall, if it was found at one of the leaf's faces.

    Args:
        doorway: As its image tells.
        leaf: Its only leaf.
        points: (N, 3) points round the doorway in wall coordinates [m].
        cameras: (3,) centres of the cameras likewise.
    """
    if leaf.opens != "inward" or leaf.hinge == "none" or not LEAST_ANGLE < leaf.opening_angle < LARGEST_ANGLE:
        return doorway
    # as seen from the hinge: along the closed leaf, and into the room
    sign, side = (1.0, doorway.left) if leaf.hinge == "left" else (-1.0, doorway.right)
    face = np.column_stack([sign * (leaf.points[:, 0] - side), leaf.points[:, 1]]).astype(np.float64)
    centre, angle = total_least_squares(face, leaf.opening_angle)
    along = np.array([np.cos(angle), np.sin(angle)])
    out = np.array([along[1], -along[0]])  # from the leaf towards the doorway
    meets = float(centre[0] - along[0] / along[1] * centre[1])
    middle = np.abs(points[:, 1] - (doorway.bottom + doorway.top) / 2) < 0.4 * doorway.height
    plan = np.column_stack([sign * (points[middle, 0] - side), points[middle, 2]]).astype(np.float64) - centre
    places = np.array([[sign * (camera[0] - side), camera[2]] for camera in cameras]) - centre
    radius = plan @ along + float(centre @ along)
    on_leaf = (radius > FIRST_RADIUS) & (radius < doorway.width)
    shown = _shown_face(plan[on_leaf] @ out, radius[on_leaf] / doorway.width, places @ out, doorway.width)
    if shown is None:
        return doorway
    which, thickness = shown
    inner = meets + (thickness / float(out[0]) if which == "back" else 0.0)
    back = inner - thickness / float(out[0])
    if min(abs(back), abs(inner)) > SAME_SIDE:
        return doorway
    moved = side + sign * back
    left, right = (moved, doorway.right) if sign > 0 else (doorway.left, moved)
    return Rectangle(left, doorway.bottom, right, doorway.top)


def _shown_face(
    offsets: NDArray[np.float64], along: NDArray[np.float64], cameras: NDArray[np.float64], width: float
) -> tuple[Literal["back", "inner"], float] | None:
    """Which of the leaf's faces the line lies on, and how thick the leaf is [m]; None if nothing tells.

    Args:
        offsets: (N,) distance of points from the line, towards the doorway [m].
        along: (N,) where they lie on the leaf, 0 to 1 from the hinge.
        cameras: (K,) distances like those of the points.
        width: Of the leaf [m].
    """
    edges = np.arange(-THICKNESS[1] - BIN / 2, THICKNESS[1] + BIN, BIN)
    counts = np.histogram(offsets, edges)[0]
    middles = (edges[:-1] + edges[1:]) / 2
    other = middles[int(np.where(np.abs(middles) > THICKNESS[0], counts, 0).argmax())]
    near = np.abs(offsets - other) < BIN
    pieces = max(1, round(width / PIECE))
    seen = np.bincount((along[near] * pieces).astype(int), minlength=pieces) >= FEW
    if seen.mean() > SEEN:
        thickness = float(np.median(offsets[near]))
        return ("back" if thickness > 0 else "inner"), abs(thickness)
    well = cameras[np.abs(cameras) > WELL_BESIDE]
    if len(well) and (well > 0).all():
        return "inner", USUAL_THICKNESS
    if len(well) and (well < 0).all():
        return "back", USUAL_THICKNESS
    return None
