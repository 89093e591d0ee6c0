"""The lower edge of a door's leaf, a finger above the floor, from the points themselves (ours).

Orthoimages begin above the floor's own points. Near the leaf's plane the heights of all points show both: the floor is
a peak, as wide as the noise of its range seen at a slant; the leaf is as many points a millimetre from its lower edge
upwards.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from detector.angle import slope_in_doorway, total_least_squares
from detector.orthoimage import LOW
from detector.parameters import DetectorParameters
from detector.result import Door, Orthoimage

PLATEAU = 0.05
"""Above this height a leaf has all its points [m]: more than the undercut of a door to a bathroom."""
BIN = 0.001
"""[m]"""
NEAR = 0.012
"""Points this close to the leaf's plane are on it, or on the floor beside it [m]: 4 sigma of the scanner."""
BESIDE = 0.05
"""The jambs' own points [m]."""
LEAST_DENSITY = 6.0
"""Fewer points a bin than this on the leaf tell nothing."""
FLOOR_PEAK = 4
"""The floor's peak lies within this many bins of its height."""


def with_lower_edge(
    door: Door,
    low: NDArray[np.float32],
    merged: Orthoimage,
    height: float,
    floor: float,
    parameters: DetectorParameters,
) -> Door:
    """The door with its doorway's bottom on the lower edge of the leaf that shows it best; else on the floor.

    Args:
        low: (N, 3) points of the wall's slab just above and at the floor, in wall coordinates [m].
        height: Height of the wall [m].
        floor: Height of the floor along v [m].
    """
    if not parameters.settle_sides:
        return door
    edges = [lower_edge(points - floor) for points in _on_leaves(door, low, merged, height)]
    found = [edge for edge in edges if edge is not None]
    return replace(door, rectangle=replace(door.rectangle, bottom=floor + min(found))) if found else door


def _on_leaves(door: Door, low: NDArray[np.float32], merged: Orthoimage, height: float) -> list[NDArray[np.float32]]:
    """Heights of the low points near each leaf's plane."""
    doorway, result = door.rectangle, []
    u, v, depth = low.T
    inner = (u > doorway.left + BESIDE) & (u < doorway.right - BESIDE)
    for leaf in door.leaves:
        if len(leaf.points):
            centre, direction = total_least_squares(leaf.points.astype(np.float64), 0.0)
            away = (depth - centre[1]) * np.cos(direction) - (u - centre[0]) * np.sin(direction)
        else:
            angle, offset, _ = slope_in_doorway(merged.depth, doorway, height, merged.pixel_size)
            away = depth - offset - (u - (doorway.left + doorway.right) / 2) * np.tan(angle)
        result.append(v[inner & (np.abs(away) < NEAR)])
    return result


def lower_edge(heights: NDArray[np.float32]) -> float | None:
    """Height [m] from which the points of a leaf are as dense as above; None if there are too few, or not within 5 cm.

    Args:
        heights: (N,) over the floor [m]; the floor's own points and the leaf's.
    """
    counts, borders = np.histogram(heights, np.arange(LOW[0], LOW[1] + BIN / 2, BIN))
    density = float(np.median(counts[borders[:-1] >= PLATEAU]))
    if density < LEAST_DENSITY:
        return None
    leaf = counts - _floor_peak(counts, round(-LOW[0] / BIN))
    smooth = np.convolve(leaf, np.ones(3) / 3, mode="same")
    below = np.flatnonzero(smooth[: round((PLATEAU - LOW[0]) / BIN)] < density / 2)
    if len(below) == 0:
        return None
    first = int(below[-1])  # from here on upwards it is leaf
    if smooth[first + 1] < density / 2:
        return None
    rise = smooth[first + 1] - smooth[first]
    return max(0.0, LOW[0] + BIN * (first + 0.5 + float((density / 2 - smooth[first]) / rise)))


def _floor_peak(counts: NDArray[np.int64], zero: int) -> NDArray[np.float64]:
    """Counts that the floor's points make: the Gaussian through the highest bins next to height zero."""
    near = counts[zero - FLOOR_PEAK : zero + FLOOR_PEAK]
    top = zero - FLOOR_PEAK + int(near.argmax())
    low, high, up = np.log(np.maximum(counts[top - 1 : top + 2], 1).astype(np.float64))
    curvature = 2 * high - low - up
    if curvature <= 0:
        return np.zeros(len(counts))
    shift = (up - low) / (2 * curvature)
    peak = high + (up - low) ** 2 / (8 * curvature)
    return np.exp(peak - 0.5 * curvature * (np.arange(len(counts)) - top - shift) ** 2)
