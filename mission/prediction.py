"""What a scan from some place would see of given surface cells, as far as the known points stand in the way.

No ray marching: the known points are sorted into the place's own depth maps, azimuth by elevation, and a cell is hidden
if the map holds something nearer in its direction. A point stands for the cube that it represents; near the scanner the
cube fills many bins, so near points go into coarser maps, in which they fill about one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

_LEVELS = 4
"""Depth maps, each with bins twice as wide as the last one's."""


class ScannerView(BaseModel):
    """What the scanner can see, and how finely that is predicted."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    lowest_elevation_deg: float = Field(default=-40.0, ge=-90.0, le=0.0, description="VZ-400: zenith angle 130 deg")
    highest_elevation_deg: float = Field(default=60.0, ge=0.0, le=90.0, description="VZ-400: zenith angle 30 deg")
    min_range: float = Field(default=1.5, ge=0.0, le=5.0, description="VZ-400 [m]")
    max_range: float = Field(default=10.0, gt=1.0, le=100.0, description="Beams are too far apart beyond [m]")
    max_incidence_deg: float = Field(default=75.0, gt=0.0, lt=90.0, description="Flatter beams see little")
    occluder: float = Field(default=0.1, ge=0.02, le=0.5, description="Side of the cubes that hide what is behind [m]")
    bin_deg: float = Field(default=1.5, ge=0.2, le=5.0, description="Width of the finest depth map's bins")


@dataclass(frozen=True, eq=False)
class Cells:
    """Small pieces of surface."""

    centres_in_world: NDArray[np.float64]
    """(M, 3) [m]."""
    normals_in_world: NDArray[np.float64]
    """(M, 3) unit vectors towards the side that is looked at."""


@dataclass(frozen=True, eq=False)
class Prospect:
    """How cells would look from one place."""

    seen: NDArray[np.bool_]
    """(M,) within field of view, range and incidence, and nothing known in between."""
    cosine: NDArray[np.float64]
    """(M,) of the angle of incidence; negative from behind."""
    bearing: NDArray[np.float64]
    """(M,) where the place lies as seen from the cell: angle in plan from the cell's normal, anticlockwise [rad]."""


def cubes(points_in_world: NDArray[np.floating], cells: Cells, *, side: float) -> NDArray[np.float64]:
    """(K, 3) centres of the cubes that hold points, in the order of their position; far from all cells none is kept."""
    low, high = cells.centres_in_world.min(axis=0) - side, cells.centres_in_world.max(axis=0) + side
    inside = ((points_in_world >= low) & (points_in_world <= high)).all(axis=1)
    index = np.floor((points_in_world[inside] - low) / side).astype(np.int64)
    size = np.floor((high - low) / side).astype(np.int64) + 1
    key = np.unique(np.ravel_multi_index(tuple(index.T), tuple(size)))
    return low + (np.stack(np.unravel_index(key, tuple(size)), axis=1) + 0.5) * side


def prospect(
    scanner_in_world: NDArray[np.float64], cells: Cells, occluders_in_world: NDArray[np.float64], view: ScannerView
) -> Prospect:
    """Predict how cells would look from a (3,) place, given the (K, 3) centres of occluding cubes."""
    towards = scanner_in_world - cells.centres_in_world
    normals = cells.normals_in_world
    distance = np.sqrt((towards**2).sum(axis=1))
    cosine = (towards * normals).sum(axis=1) / np.maximum(distance, 1e-9)
    elevation = np.arcsin(np.clip(-towards[:, 2] / np.maximum(distance, 1e-9), -1, 1))
    seen = (distance >= view.min_range) & (distance <= view.max_range)
    seen &= cosine >= np.cos(np.radians(view.max_incidence_deg))
    seen &= elevation >= np.radians(view.lowest_elevation_deg)
    seen &= elevation <= np.radians(view.highest_elevation_deg)
    seen[seen] = ~_hidden(-towards[seen], cosine[seen], occluders_in_world - scanner_in_world, view)
    across = normals[:, 0] * towards[:, 1] - normals[:, 1] * towards[:, 0]
    along = normals[:, 0] * towards[:, 0] + normals[:, 1] * towards[:, 1]
    return Prospect(seen=seen, cosine=cosine, bearing=np.arctan2(across, along))


def _hidden(
    offsets: NDArray[np.float64], cosine: NDArray[np.float64], occluders: NDArray[np.float64], view: ScannerView
) -> NDArray[np.bool_]:
    """(M,) which cells at (M, 3) offsets from the scanner have one of (K, 3) occluders in front."""
    width = np.radians(view.bin_deg)
    level = np.log2(view.occluder / (np.maximum(np.hypot(occluders[:, 0], occluders[:, 1]), 1e-9) * width))
    level = np.clip(np.ceil(level), 0, _LEVELS - 1).astype(np.int64)
    directions = _direction(occluders)
    depth = np.sqrt((occluders**2).sum(axis=1))
    distance = np.sqrt((offsets**2).sum(axis=1))
    looks = _direction(offsets)
    # Along an oblique surface one bin spans a range of depths: the surface must not hide itself.
    slope = np.sqrt(np.maximum(1 - cosine**2, 0)) / cosine
    hidden = np.zeros(len(offsets), dtype=np.bool_)
    for n in range(_LEVELS):
        chosen = level == n
        bins = width * 2**n
        nearest = np.full((int(np.pi / bins) + 2) * (int(2 * np.pi / bins) + 2), np.inf)
        np.minimum.at(nearest, _bin(directions[:, chosen], bins), depth[chosen])
        hidden |= nearest[_bin(looks, bins)] < distance - 2 * view.occluder - distance * bins * slope
    return hidden


def _direction(offsets: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, N) azimuth in [0, 2 pi] and polar angle from the nadir in [0, pi] [rad]."""
    azimuth = np.arctan2(offsets[:, 1], offsets[:, 0]) + np.pi
    return np.stack([azimuth, np.arctan2(offsets[:, 2], np.hypot(offsets[:, 0], offsets[:, 1])) + np.pi / 2])


def _bin(directions: NDArray[np.float64], width: float) -> NDArray[np.int64]:
    """(N,) index of the bin that a direction falls into."""
    azimuth, polar = (directions / width).astype(np.int64)
    return polar * (int(2 * np.pi / width) + 2) + azimuth
