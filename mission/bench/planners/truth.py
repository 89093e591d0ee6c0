"""The structure of a room that can be seen at all, and how much of it scans have seen: the truth about coverage.

The visible structure are the surfaces of walls, floor and ceiling on which an exact scanner has a return from any of
the places where the robot can stand, taken 1.5 m apart, in cells of 10 cm. It belongs to the room if it is hit alike
when all doors are closed and all glass is opaque. Floor is what faces upward at the floor's height; ceiling what faces
downward more than 2 m above it; wall what is upright and has, straight above or below within 10 cm in plan, an
upright surface that goes on to the ceiling: doors that are closed and pictures are wall, wardrobes are not. A cell is
seen when a scan has a return within 7 cm of its middle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mission.bench.planners.rooms import TrueRoom, closed
from mission.rigid import Pose, transformed
from mission.samples import place, sample_scan, thinned
from sim.scanner import Scan, Scanner, ScannerParameters
from sim.scene import Scene

CELL = 0.1
"""Side of a cell [m]."""
SEEN_WITHIN = 0.07
"""From a cell's middle to the return that counts [m]: half the cell's diagonal."""
APART = 1.5
"""No place is farther than this from one that is looked from [m]."""

_SAME = 0.01
_AT_FLOOR = 0.03
_CEILING_FROM = 2.0
_WALL_TOP = 2.1
_UNDER_CEILING = 0.3
_LEVEL, _UPRIGHT = 0.9, 0.3
"""Cosines of a normal with the vertical."""


def visible_structure(scene: Scene, room: TrueRoom, base_from_scanner: Pose) -> NDArray[np.float64]:
    """(C, 3) middles of the cells of walls, floor and ceiling that can be seen from where the robot can stand [m].

    Args:
        scene: With its doors as they stand.
        room: One of `rooms_of(scene)`.
        base_from_scanner: (4, 4) mount of the scanner.
    """
    points, normals = _seen_from(scene, room, base_from_scanner)
    floor = room.world_from_base[2, 3]
    height, up = points[:, 2] - floor, normals[:, 2]
    level = (up > _LEVEL) & (abs(height) < _AT_FLOOR)
    overhead = (up < -_LEVEL) & (height > _CEILING_FROM)
    lowest_ceiling = np.quantile(height[overhead], 0.05) if overhead.any() else np.inf
    wall = _walls(points, abs(up) < _UPRIGHT, floor + max(_WALL_TOP, min(lowest_ceiling, 1e3) - _UNDER_CEILING))
    if not overhead.any():
        wall = _walls(points, abs(up) < _UPRIGHT, floor + _WALL_TOP)
    return np.concatenate([_cells(points[which]) for which in (level, overhead, wall)])


def seen(cells: NDArray[np.float64], scan: Scan, true_world_from_scanner: Pose) -> NDArray[np.bool_]:
    """(C,) which of the cells (C, 3) a scan from a pose (4, 4) has a return of."""
    from scipy.spatial import cKDTree

    points = transformed(scan.points(), true_world_from_scanner)
    low, high = cells.min(axis=0) - SEEN_WITHIN, cells.max(axis=0) + SEEN_WITHIN
    points = points[((points > low) & (points < high)).all(axis=1)]
    if len(points) == 0:
        return np.zeros(len(cells), bool)
    tree = cKDTree(points, balanced_tree=False, compact_nodes=False)
    return np.isfinite(tree.query(cells, distance_upper_bound=SEEN_WITHIN)[0])


def _seen_from(
    scene: Scene, room: TrueRoom, base_from_scanner: Pose
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (N, 3) of the room's surfaces in sight from anywhere in it, and their normals (N, 3)."""
    exact = ScannerParameters(pattern="draft", noise=False)
    shut_model, shut_data = closed(scene)
    opened, shut = (Scanner(model, exact, hidden_bodies=scene.robot_bodies) for model in (scene.model, shut_model))
    noiseless = np.random.default_rng(0)
    points, normals = [], []
    for spot in _spread(room.places_in_world):
        pose = np.eye(4)
        pose[:3, 3] = spot + base_from_scanner[:3, 3]
        scan = opened.scan(scene.data, pose, noiseless)
        same = abs(scan.ranges - shut.scan(shut_data, pose, noiseless).ranges) < _SAME  # not where one is NaN
        scan.ranges[~same] = np.nan
        sample = place(sample_scan(scan), pose)
        flat = np.isfinite(sample.normals_in_world[:, 0])
        points.append(sample.points_in_world[flat].astype(np.float64))
        normals.append(sample.normals_in_world[flat].astype(np.float64))
    return np.concatenate(points), np.concatenate(normals)


def _spread(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """(S, 3) of the places (P, 3), each the one farthest from those before, until all have one within `APART`."""
    chosen = [0]
    distance = np.hypot(*(places - places[0]).T[:2])
    while distance.max() > APART:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.hypot(*(places - places[chosen[-1]]).T[:2]))
    return places[chosen]


def _walls(points: NDArray[np.float64], upright: NDArray[np.bool_], top: float) -> NDArray[np.bool_]:
    """(N,) upright points near which, in plan, something upright rises above a height [m]."""
    from scipy.spatial import cKDTree

    high = upright & (points[:, 2] > top)
    wall = np.zeros(len(points), bool)
    if high.any():
        outline = points[high][:, :2]
        outline = outline[thinned(np.pad(outline, ((0, 0), (0, 1))), CELL / 2, first=_all(outline))]
        distance, _ = cKDTree(outline).query(points[upright, :2], distance_upper_bound=CELL)
        wall[upright] = np.isfinite(distance)
    return wall


def _cells(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(C, 3) mean of the points in each cell of a raster that no scene's walls are likely to lie on the edges of."""
    if len(points) == 0:
        return np.empty((0, 3))
    cell = np.floor(points / CELL + np.array([0.37, 0.43, 0.41])).astype(np.int64)
    _, inverse, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(inverse.ravel(), points[:, axis]) for axis in range(3)], axis=1)
    return sums / count[:, None]


def _all(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.ones(len(points), bool)
