"""Where the robot is, by what its Hokuyos see of the scanned room: keeps the drift of the odometry within centimetres.

Point-to-line ICP in the Hokuyos' plane, with the odometry as a prior: along a bare corridor it moves nothing that the
readings do not tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sim.parameters import Parameters

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

    from sim.laser_scan import LaserScan


class LocalisationParameters(Parameters):
    """How readings are matched with the scanned room."""

    band: float = Field(default=0.05, ge=0.005, le=0.5, description="Points so near the lasers' plane are its map [m]")
    laser_range: float = Field(default=4.0, gt=0.5, le=5.6, description="Readings count up to here: guaranteed [m]")
    reaches: tuple[Annotated[float, Field(gt=0, le=10)], ...] = Field(
        default=(0.3, 0.3, 0.2, 0.1, 0.1, 0.06),
        min_length=1,
        max_length=50,
        description="How far a reading's partner may be, step by step [m]",
    )
    noise: float = Field(default=0.03, ge=0.001, le=0.2, description="Of a reading against the map [m]; 1 % of 3 m")
    independent: float = Field(
        default=50.0, gt=1.0, le=10_000.0, description="Readings that err independently of each other"
    )
    drift: float = Field(
        default=0.05, ge=0.001, le=1.0, description="Of the odometry since the last match, 1 sigma [m]"
    )
    turn_drift: float = Field(default=0.03, ge=0.001, le=1.0, description="Likewise of its heading [rad]")
    min_fitness: float = Field(default=0.5, ge=0.0, le=1.0, description="Share of readings that must find a partner")


@dataclass(frozen=True, eq=False)
class LaserMap:
    """The scanned room in the plane of the Hokuyos."""

    points: NDArray[np.float64]
    """(N, 2) in the world [m]."""
    normals: NDArray[np.float64]
    """(N, 2) unit."""

    @cached_property
    def tree(self) -> cKDTree:
        """Finds the nearest point."""
        from scipy.spatial import cKDTree

        return cKDTree(self.points)


def laser_map(
    points_in_world: NDArray[np.floating],
    normals_in_world: NDArray[np.floating],
    *,
    height: float,
    parameters: LocalisationParameters | None = None,
) -> LaserMap:
    """Cut the scans at the height of the Hokuyos.

    Args:
        points_in_world: (N, 3) points of all scans [m].
        normals_in_world: (N, 3) unit normals, NaN where there is none; only upright surfaces are taken.
        height: World z of the Hokuyos' plane [m].
    """
    parameters = parameters or LocalisationParameters()
    level = np.hypot(normals_in_world[:, 0], normals_in_world[:, 1])
    kept = (abs(points_in_world[:, 2] - height) < parameters.band) & (level > 0.8)  # NaN compares false
    normals = normals_in_world[kept, :2] / level[kept, None]
    return LaserMap(points_in_world[kept, :2].astype(np.float64), normals.astype(np.float64))


def localise(
    room: LaserMap,
    scans: Sequence[LaserScan],
    world_from_base: NDArray[np.float64],
    *,
    parameters: LocalisationParameters | None = None,
) -> NDArray[np.float64]:
    """(4, 4) the pose at which the readings fit the room best, near the one given; that one if they do not fit.

    Args:
        scans: Readings of the Hokuyos, taken at the same time.
        world_from_base: (4, 4) pose by odometry since the last match.
    """
    parameters = parameters or LocalisationParameters()
    readings = readings_in_base(scans, up_to=parameters.laser_range)
    if len(readings) == 0 or len(room.points) == 0:
        return world_from_base
    start = np.array([*world_from_base[:2, 3], np.arctan2(world_from_base[1, 0], world_from_base[0, 0])])
    prior = np.diag([parameters.drift**-2, parameters.drift**-2, parameters.turn_drift**-2])
    pose, fitness = start, 0.0
    for reach in parameters.reaches:
        arms = readings @ _rotation(pose[2]).T
        distance, partner = room.tree.query(arms + pose[:2], distance_upper_bound=reach)
        found = np.isfinite(distance)
        fitness = float(found.mean())
        arms, partner = arms[found], partner[found]
        normals = room.normals[partner]
        residual = ((arms + pose[:2] - room.points[partner]) * normals).sum(axis=1)
        slopes = np.column_stack([normals, normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]])
        weights = _weights(residual, parameters)
        information = prior + np.einsum("n,ni,nj->ij", weights, slopes, slopes)
        pull = prior @ (pose - start) + np.einsum("n,ni,n->i", weights, slopes, residual)
        pose = pose - np.linalg.solve(information, pull)
    if fitness < parameters.min_fitness:
        return world_from_base
    moved = world_from_base.copy()
    moved[:2, :2] = _rotation(pose[2] - start[2]) @ world_from_base[:2, :2]
    moved[:2, 3] = pose[:2]
    return moved


def readings_in_base(scans: Sequence[LaserScan], *, up_to: float = np.inf) -> NDArray[np.float64]:
    """(N, 2) readings of all scans up to a range, in the base frame [m]."""
    return np.concatenate([np.empty((0, 2)), *(scan.points_in_base(up_to=up_to)[:, :2] for scan in scans)])


def _weights(residual: NDArray[np.float64], parameters: LocalisationParameters) -> NDArray[np.float64]:
    """(n,) Cauchy weights [1/m2], together worth so many independent readings."""
    robust = 1 / (1 + (residual / parameters.noise) ** 2)
    return robust * parameters.independent / max(len(residual), 1) / parameters.noise**2


def _rotation(angle: float) -> NDArray[np.float64]:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
