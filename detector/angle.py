"""Opening angle of door leaves (section 6.3).

A leaf is a line in plan that starts at a jamb. The paper draws random pairs of points (RANSAC); with the doorway known
only the depth of the hinge and the angle are unknown, few enough to try all of them, so that the consensus is the best
there is and no random number is needed. The line is then fitted to its inliers by total least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.parameters import DetectorParameters
from detector.result import Leaf, Orthoimage, Rectangle

HINGE_DEPTHS = np.arange(-0.30, 0.091, 0.02)
"""Where the hinge may lie: up to a wall's thickness behind the plane, up to a frame's before it [m]."""
FACE_OFFSETS = (0.0, 0.025, 0.05, -0.02)
"""How far into the doorway the seen face may start: a wide open leaf may show the one that is its thickness off [m]."""
ANGLE_STEP = np.deg2rad(0.5)
RADIAL_STEP = 0.04
"""Length of the pieces of a leaf that must be seen [m]."""
NEAREST_RADIUS = 0.08
"""Points nearer to the hinge belong to the jamb [m]."""
MIN_COVER = 0.35
"""Least share of the leaf's length that is seen."""
MAX_SLICE = 40_000
"""Points that are enough for one leaf."""
SLICE = 0.1
"""Half height of the slice at half height [m]."""
MIN_POINTS = 40
CLOSED_SHARE = 0.6
"""Share of a doorway's columns that a closed leaf fills at least."""


class LeafFit(NamedTuple):
    """A leaf that was found on one hinge side."""

    leaf: Leaf
    cover: float
    """Share of the leaf's length that was seen."""
    hinge_depth: float
    """Depth of its line at the jamb [m]."""

    @property
    def likelihood(self) -> float:
        """Tells hinge sides apart: a slightly open leaf is one line from jamb to jamb, hung at the end in the wall."""
        return self.cover - abs(self.hinge_depth)


@dataclass(frozen=True)
class _Line:
    """A leaf hypothesis in plan, seen from its hinge: r along the closed leaf, d into the room."""

    start: tuple[float, float]
    """r and d of the point that the leaf's face starts from [m]."""
    angle: float
    """From the closed leaf, positive into the room [rad]."""
    cover: float
    """Share of the leaf's length that has points."""


def fit_leaf(
    points: NDArray[np.float32], doorway: Rectangle, hinge: Literal["left", "right"], parameters: DetectorParameters
) -> LeafFit | None:
    """The open leaf on one hinge side.

    Args:
        points: (N, 3) points round the doorway in wall coordinates [m].
        doorway: What this leaf fills when it is closed.

    Returns:
        The leaf, or None where no line looks like one.
    """
    width = doorway.width
    sign, corner = (1.0, doorway.left) if hinge == "left" else (-1.0, doorway.right)
    # beyond the leaf, too, to tell a wall that goes on
    low, high = sorted((corner - sign * 0.5, corner + sign * (width + 0.8)))
    index = np.flatnonzero((points[:, 0] > low) & (points[:, 0] < high) & _slice(points[:, 1], doorway, parameters))
    r, d = sign * (points[index, 0] - corner), points[index, 2]
    # what lies in the wall's own plane beside the doorway is wall
    chosen = np.hypot(r, d) < width + 0.8
    chosen &= ~((np.abs(d) < 0.07) & ((r < 0.02) | (r > width - 0.01)))
    kept = np.flatnonzero(chosen)
    kept = kept[:: 1 + len(kept) // MAX_SLICE]
    if len(kept) < MIN_POINTS:
        return None
    plan = np.stack([r[kept], d[kept]], axis=1).astype(np.float64)
    line = _consensus(plan, width, parameters)
    if line is None:
        return None
    return _refine(plan, points[index[kept], 1], line, (hinge, sign, corner), (doorway, parameters))


def _slice(v: NDArray[np.float32], doorway: Rectangle, parameters: DetectorParameters) -> NDArray[np.bool_]:
    """(N,) the points, by their height, that the line is fitted to: away from floor and lintel, or at half height."""
    middle = (doorway.bottom + doorway.top) / 2
    reach = SLICE if parameters.leaf_slice == "half-height" else 0.42 * doorway.height
    return np.abs(v - middle) < reach


def _consensus(plan: NDArray, width: float, parameters: DetectorParameters) -> _Line | None:
    """The hinge depth and angle whose ray from the hinge meets points over the most of the leaf's length."""
    leaf_bins, first = round(width / RADIAL_STEP), round(NEAREST_RADIUS / RADIAL_STEP)
    best: _Line | None = None
    best_score = MIN_COVER
    across, out = plan.T.astype(np.float32)
    # the starts nearest to the jamb on the wall's face come first: of equal covers they are the better ones
    starts = sorted(product(HINGE_DEPTHS, FACE_OFFSETS), key=_start_cost)
    for depth, offset in starts:
        cost = _start_cost((depth, offset))
        if 1 + np.log1p(3 * len(plan)) / 100 - cost <= best_score:
            break  # not even a leaf that is seen over its whole length would be better
        counts = _polar_counts(across - np.float32(offset), out - np.float32(depth), width, parameters)
        # a leaf is as thick in angle as its points scatter, which near the hinge is more than one step
        counts = counts + np.roll(counts, 1, axis=1) + np.roll(counts, -1, axis=1)
        occupied = counts >= max(3, len(plan) // 4000)
        cover = occupied[first:leaf_bins].mean(axis=0)
        beyond = occupied[leaf_bins + 3 :].mean(axis=0)  # a wall goes on where a leaf ends
        # of equal covers the one with more points
        dense = np.log1p(counts[first:leaf_bins].sum(axis=0)) / 100
        score = cover - 0.7 * beyond - cost + dense
        angles = (np.arange(len(score)) + 0.5) * ANGLE_STEP - parameters.max_angle
        score[np.abs(angles) < parameters.closed_angle] = -1
        i = int(score.argmax())
        if score[i] > best_score and cover[i] >= MIN_COVER:
            best, best_score = _Line((offset, float(depth)), float(angles[i]), float(cover[i])), float(score[i])
    return best


def _start_cost(start: tuple[float, float]) -> float:
    """What the depth and offset of a leaf's start take off its score."""
    return 0.3 * abs(float(start[0])) + abs(start[1])


def _polar_counts(
    along: NDArray[np.float32], out: NDArray[np.float32], width: float, parameters: DetectorParameters
) -> NDArray[np.int64]:
    """(radii, angles) number of points in steps of radius and of angle round the origin."""
    angles = int(np.ceil(2 * parameters.max_angle / ANGLE_STEP)) + 1
    radii = int(np.ceil((width + 0.4) / RADIAL_STEP))
    radius, angle = np.sqrt(along * along + out * out), np.arctan2(out, along)
    inside = (np.abs(angle) < parameters.max_angle) & (radius < radii * RADIAL_STEP)
    cells = (radius[inside] / RADIAL_STEP).astype(np.int32) * angles
    cells += ((angle[inside] + parameters.max_angle) / ANGLE_STEP).astype(np.int32)
    return np.bincount(cells, minlength=radii * angles)[: radii * angles].reshape(radii, angles)


def _refine(
    plan: NDArray, v: NDArray, line: _Line, side: tuple[Literal["left", "right"], float, float], of: tuple
) -> LeafFit | None:
    """Total least squares on the inliers of the hypothesis."""
    (hinge, sign, corner), (doorway, parameters) = side, of
    angle, origin = line.angle, np.array(line.start)
    tolerance = 0.035
    keep = np.zeros(len(plan), bool)
    for round_number in range(6):
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]])
        radius, offset = (plan - origin) @ along, (plan - origin) @ across
        near = (radius > 0.03) & (radius < doorway.width + 0.06) & (np.abs(offset) < tolerance)
        if near.sum() < MIN_POINTS:
            return None
        if round_number == 0:  # a leaf seen from both sides shows two faces: stay with the denser one
            histogram, edges = np.histogram(offset[near], np.arange(-tolerance, tolerance + 0.005, 0.005))
            peak = edges[np.convolve(histogram, [1, 1, 1], "same").argmax()] + 0.0025
            keep = near & (np.abs(offset - peak) < 1.5 * parameters.leaf_inlier)
        else:
            keep = near
        if keep.sum() < MIN_POINTS:
            return None
        origin, angle = total_least_squares(plan[keep], angle)
        tolerance = parameters.leaf_inlier
        origin = origin - along * ((origin - np.array(line.start)) @ along)  # radii keep counting from the hinge
    spread = radius[keep]
    if np.ptp(v[keep]) < 0.3 * doorway.height and parameters.leaf_slice == "all":
        return None
    scatter = max(float(np.std(offset[keep])), 1e-4)
    std = scatter / np.sqrt(max(((spread - spread.mean()) ** 2).sum(), 1e-9))
    points = np.stack([corner + sign * plan[keep, 0], plan[keep, 1]], axis=1).astype(np.float32)
    points = points[:: 1 + len(points) // 5000]
    cover = len(np.unique((spread / RADIAL_STEP).astype(int))) * RADIAL_STEP / doorway.width
    opens: Literal["inward", "outward"] = "inward" if angle > 0 else "outward"
    leaf = Leaf(hinge, abs(float(angle)), float(std), opens, points)
    return LeafFit(leaf, min(cover, 1.0), float(origin[1] - origin[0] * np.tan(angle)))


def total_least_squares(plan: NDArray, angle: float) -> tuple[NDArray, float]:
    """Centroid and direction of the line through points (N, 2); the direction nearest to `angle` [rad]."""
    centre = plan.mean(axis=0)
    x, y = (plan - centre).T
    direction = 0.5 * np.arctan2(2 * (x * y).sum(), (x * x).sum() - (y * y).sum())
    turns = np.round((angle - direction) / np.pi)
    return centre, float(direction + turns * np.pi)


def closed_depth(doorway: Rectangle, merged: Orthoimage, height: float, parameters: DetectorParameters) -> float | None:
    """Depth [m] of the plane parallel to the wall that fills a doorway; None if none does."""
    angle, depth, share = slope_in_doorway(merged.depth, doorway, height, merged.pixel_size)
    return depth if share >= CLOSED_SHARE and abs(angle) < parameters.closed_angle else None


def slope_in_doorway(
    depth: NDArray[np.float32], doorway: Rectangle, height: float, pixel_size: float
) -> tuple[float, float, float]:
    """Angle [rad], depth [m] and share of the plane that fills a doorway, from the orthoimage's depth.

    Returns:
        Angle against the wall's plane (positive: nearer on the right), depth at the middle, and the share of the
        doorway's columns that lie on it; (NaN, NaN, 0) where less than a third of the columns has data.
    """
    margin = 0.04
    rows = np.s_[
        max(0, int((height - doorway.top + margin) / pixel_size)) : int((height - doorway.bottom - 0.1) / pixel_size)
    ]
    first, last = (int(x / pixel_size) for x in (doorway.left + margin, doorway.right - margin))
    inner = depth[rows, max(first, 0) : last]
    if inner.size == 0:
        return float("nan"), float("nan"), 0.0
    data = np.isfinite(inner)
    filled = np.flatnonzero(data.mean(axis=0) > 0.3)
    if len(filled) < max(3, inner.shape[1] / 3):
        return float("nan"), float("nan"), 0.0
    medians = np.nanmedian(inner[::2, filled], axis=0).astype(np.float64)
    x = filled * pixel_size
    i, j = np.triu_indices(len(x), max(1, len(x) // 3))
    slope = float(np.median((medians[j] - medians[i]) / (x[j] - x[i])))
    middle = inner.shape[1] * pixel_size / 2
    offset = float(np.median(medians - slope * (x - middle)))
    on_plane = np.abs(medians - slope * (x - middle) - offset) < 0.015
    return float(np.arctan(slope)), offset, float(on_plane.sum() / inner.shape[1])
