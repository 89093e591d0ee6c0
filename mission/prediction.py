"""What a scan from some place would see of given surface cells, as far as is known what stands in the way.

No ray marching. Furniture: its points are sorted into the place's own depth maps, azimuth by elevation, and a cell is
hidden if a map holds something nearer in its direction. A point stands for a cube of space; near the scanner the cube
fills many bins, so near points go into coarser maps, in which they fill about one. Walls: the line of sight is cut with
the sides of the room's polygon.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.by_columns import chosen, gathered
from sim.parameters import Parameters
from sim.scan import ScannerParameters

_LEVELS = 4
"""Depth maps, each with bins twice as wide as the last one's."""
_TOUCH = 0.15
"""What is hit within this distance of a cell does not hide it [m]: for the edges of voxels and cubes."""
_WALL_TOUCH = 0.3
"""Likewise for the sides of the room [m]: polygon and walls may differ by centimetres, met at a grazing angle."""
_DIAGONAL = 1.5
"""Neighbouring cubes of a surface lie up to this many sides apart: a bin must not be narrower, or it leaves holes."""


class ScannerView(Parameters):
    """What of the scanner's view counts, and how finely it is predicted."""

    max_range: float = Field(default=10.0, gt=1.0, le=100.0, description="Beams are too far apart beyond [m]")
    max_incidence: float = Field(
        default=math.radians(75), gt=0.0, lt=math.pi / 2, description="Flatter beams see little [rad]"
    )
    cube: float = Field(default=0.05, ge=0.02, le=0.5, description="Side of the cubes that points stand for [m]")
    bin_width: float = Field(default=math.radians(0.75), ge=0.003, le=0.1, description="Of the finest depth map [rad]")


@dataclass(frozen=True, eq=False)
class Cells:
    """Small pieces of surface."""

    centres: NDArray[np.float64]
    """(M, 3) in the world [m]."""
    normals: NDArray[np.float64]
    """(M, 3) unit vectors towards the side that is looked at."""


@dataclass(frozen=True, eq=False)
class Obstacles:
    """What can stand between a scanner and the cells."""

    cubes: NDArray[np.float64]
    """(K, 3) centres of the cubes of space that hold points off the cells' surfaces, in the world [m]."""
    walls: NDArray[np.float64]
    """(P, 2) polygon of the room [m], P = 0 if there is none."""


@dataclass(frozen=True, eq=False)
class Prospect:
    """How cells would look from one place."""

    seen: NDArray[np.bool_]
    """(M,) within field of view, range and incidence, and nothing known in between."""
    towards: NDArray[np.float64]
    """(M, 3) unit vectors from the cells to the place."""
    cosine: NDArray[np.float64]
    """(M,) of the angle of incidence; negative from behind."""


def find_obstacles(
    points_in_world: NDArray[np.floating], cells: Cells, *, walls: NDArray[np.float64] | None, view: ScannerView
) -> Obstacles:
    """Gather what stands free of the surfaces that the cells are pieces of, from (N, 3) points."""
    from scipy.spatial import cKDTree

    low, high = cells.centres.min(axis=0), cells.centres.max(axis=0)
    points = gathered([points_in_world])
    inside = ((points >= low) & (points <= high)).all(axis=1)
    index = np.floor((chosen(points, inside) - low) / view.cube).astype(np.int64)
    size = tuple(np.floor((high - low) / view.cube).astype(np.int64) + 1)
    key = np.unique(np.ravel_multi_index(tuple(index.T), size))
    centres = low + (np.stack(np.unravel_index(key, size), axis=1) + 0.5) * view.cube
    distance, nearest = cKDTree(cells.centres).query(centres, distance_upper_bound=4 * view.cube)
    near = np.flatnonzero(np.isfinite(distance))
    cell = nearest[near]
    off_surface = ((centres[near] - cells.centres[cell]) * cells.normals[cell]).sum(axis=1)
    on_surface = np.zeros(len(centres), dtype=np.bool_)
    on_surface[near] = abs(off_surface) <= view.cube
    return Obstacles(cubes=chosen(centres, ~on_surface), walls=np.empty((0, 2)) if walls is None else walls)


def prospect(
    scanner_in_world: NDArray[np.float64],
    cells: Cells,
    obstacles: Obstacles,
    *,
    scanner: ScannerParameters,
    view: ScannerView,
) -> Prospect:
    """Predict how cells would look from a (3,) place."""
    towards = scanner_in_world - cells.centres
    distance = np.sqrt(_dot(towards, towards))
    towards /= np.maximum(distance, 1e-9)[:, None]
    cosine = _dot(towards, cells.normals)
    seen = (distance >= scanner.min_range) & (distance <= min(view.max_range, scanner.max_range))
    seen &= cosine >= np.cos(view.max_incidence)
    seen &= -towards[:, 2] >= np.sin(scanner.lowest_elevation)
    seen &= -towards[:, 2] <= np.sin(scanner.highest_elevation)
    at = np.flatnonzero(seen)
    at = at[~_behind_walls(scanner_in_world[:2], chosen(cells.centres, at)[:, :2], obstacles.walls)]
    at = at[~_behind_cubes(chosen(cells.centres, at) - scanner_in_world, obstacles.cubes - scanner_in_world, view)]
    seen = np.zeros(len(seen), dtype=np.bool_)
    seen[at] = True
    return Prospect(seen=seen, towards=towards, cosine=cosine)


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _behind_cubes(cells: NDArray[np.float64], cubes: NDArray[np.float64], view: ScannerView) -> NDArray[np.bool_]:
    """(M,) which (M, 3) cells have one of (K, 3) cubes in front, all as offsets from the scanner."""
    azimuth, polar, depth, level_distance = _spherical(cubes)
    finest = view.bin_width
    level = np.ceil(np.log2(_DIAGONAL * view.cube / np.maximum(level_distance * finest, 1e-6)))
    level = np.clip(level, 0, _LEVELS - 1).astype(np.intp)
    cell_azimuth, cell_polar, distance, _ = _spherical(cells)
    hidden = np.zeros(len(cells), dtype=np.bool_)
    for n in range(_LEVELS):
        width, such = finest * 2**n, level == n
        columns = int(2 * np.pi / width) + 2
        nearest = np.full((int(np.pi / width) + 2) * columns, np.inf, dtype=np.float32)
        filled = (polar[such] / width).astype(np.intp) * columns + (azimuth[such] / width).astype(np.intp)
        np.minimum.at(nearest, filled, depth[such])
        looked = (cell_polar / width).astype(np.intp) * columns + (cell_azimuth / width).astype(np.intp)
        hidden |= nearest[looked] < distance - np.float32(_TOUCH)
    return hidden


def _spherical(offsets: NDArray[np.float64]) -> tuple[NDArray[np.float32], ...]:
    """Azimuth in [0, 2 pi], angle from the nadir in [0, pi] [rad], range and range in plan [m], each (N,)."""
    x, y, z = offsets.astype(np.float32).T
    plan = np.sqrt(x * x + y * y)
    return (
        np.arctan2(y, x) + np.float32(np.pi),
        np.arctan2(z, plan) + np.float32(np.pi / 2),
        np.sqrt(plan**2 + z * z),
        plan,
    )


def _behind_walls(
    scanner: NDArray[np.float64], cells: NDArray[np.float64], polygon: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """(M,) which (M, 2) cells have a side of the (P, 2) polygon between themselves and the (2,) scanner."""
    if len(polygon) == 0:
        return np.zeros(len(cells), dtype=np.bool_)
    ray = cells - scanner
    first = polygon - scanner
    side = np.roll(polygon, -1, axis=0) - polygon
    # scanner + t ray = first + s side, solved by Cramer's rule for all cells (rows) and sides (columns)
    cross = ray[:, 0, None] * side[:, 1] - ray[:, 1, None] * side[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel: no crossing
        t = (first[:, 0] * side[:, 1] - first[:, 1] * side[:, 0]) / cross
    before = 1 - _WALL_TOUCH / np.maximum(np.hypot(ray[:, 0], ray[:, 1]), 1e-9)
    cell, other = np.nonzero((t > 0) & (t < before[:, None]))
    s = (first[other, 0] * ray[cell, 1] - first[other, 1] * ray[cell, 0]) / cross[cell, other]
    hidden = np.zeros(len(cells), dtype=np.bool_)
    hidden[cell[(s >= 0) & (s <= 1)]] = True
    return hidden
