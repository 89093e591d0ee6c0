"""The occupancy grid: where the robot's body fits, as far as scans, Hokuyos and its own track know.

A cell is free only on evidence that the whole column over it is empty up to the robot's height: the scanner saw its
floor and nothing above it (a beam from above that reaches the floor, and a table top that gives points in the same
cell). The scanner sees neither floor nor obstacle in a disc around itself (1.19 times its height: its field of view
ends at -40 deg, and its range starts at 1.5 m); there the Hokuyos speak, whose planes are 0.47 and
0.49 m high. What stands in that disc above or below their planes betrays itself by its shadow on the floor beyond:
such sectors stay unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.occupancy import Cell, Footprint, OccupancyGrid
from mission.rigid import transformed
from sim.parameters import Parameters
from sim.scan import ScannerParameters

if TYPE_CHECKING:
    from sim.laser_scan import LaserScan


class GridParameters(Parameters):
    """What counts as floor and as obstacle."""

    resolution: float = Field(default=0.05, ge=0.02, le=0.2, description="Side of a cell [m]")
    min_obstacle_height: float = Field(
        default=0.05, ge=0.02, le=0.15, description="Above the floor [m]: scanner noise is 3-5 mm"
    )
    robot_height: float = Field(
        default=1.6, ge=0.5, le=2.5, description="Top of the camera with some air, above the floor [m]"
    )
    reach: float = Field(
        default=12.0, ge=3.0, le=60.0, description="Points further than this from every scanner are left out [m]"
    )
    points_per_obstacle: int = Field(
        default=3, ge=1, le=50, description="In a cell and its eight neighbours; fewer are mixed returns"
    )
    laser_hit_range: float = Field(
        default=2.5, ge=0.5, le=4.0, description="Hokuyo hits count up to here [m]; 1 % noise beyond blurs walls"
    )
    news_from: float = Field(
        default=0.15,
        ge=0.0,
        le=1.0,
        description="So far from what is known, a hit under way is new [m]: the pose is off by centimetres there",
    )
    laser_free_range: float = Field(
        default=2.0,
        ge=0.5,
        le=4.0,
        description="Hokuyo beams clear cells up to here [m]: just past the scanner's blind disc",
    )


@dataclass(frozen=True, eq=False)
class ScannedFloor:
    """What scans tell of the floor: an image, where their points are many."""

    grid: OccupancyGrid
    """Free where the floor was seen and nothing over it."""
    seen: NDArray[np.bool_]
    """(rows, columns) where the floor was seen, whatever is over it."""
    scanners_in_world: NDArray[np.floating]
    """(S, 3) origins of the beams [m]."""
    floor_height: float
    """World z of the floor [m]."""


def scanned_floor(
    points_in_world: NDArray[np.floating],
    scanners_in_world: NDArray[np.floating],
    *,
    floor_height: float,
    parameters: GridParameters | None = None,
) -> ScannedFloor:
    """Map the floor from scans.

    Args:
        points_in_world: (N, 3) points of all scans, thinned to 3 cm or denser [m].
        scanners_in_world: (S, 3) origins of the beams [m], S >= 1.
        floor_height: World z of the floor [m].
    """
    parameters = parameters or GridParameters()
    points = _within_reach(np.asarray(points_in_world), scanners_in_world, floor_height, parameters)
    grid = _empty_grid(points, scanners_in_world, parameters)
    height = points[:, 2] - floor_height
    floor = _count(grid, points[abs(height) < parameters.min_obstacle_height]) > 0
    hits = _count(grid, points[height >= parameters.min_obstacle_height])
    around = cv2.boxFilter(hits.astype(np.float32), -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    occupied = (hits > 0) & (around > parameters.points_per_obstacle - 0.5)
    floor, occupied = _closed(floor), _closed(occupied)
    seen = np.where(occupied, Cell.OCCUPIED, np.where(floor, Cell.FREE, Cell.UNKNOWN)).astype(np.uint8)
    return ScannedFloor(replace(grid, cells=seen), floor, scanners_in_world, floor_height)


def occupancy_grid(
    scanned: ScannedFloor,
    *,
    footprint: Footprint,
    lasers: Sequence[tuple[LaserScan, NDArray[np.float64]]] = (),
    passing: Sequence[tuple[LaserScan, NDArray[np.float64]]] = (),
    robot_poses: Sequence[NDArray[np.float64]] = (),
    scanner: ScannerParameters | None = None,
    parameters: GridParameters | None = None,
) -> OccupancyGrid:
    """Map the floor from all that was measured so far.

    Occupied wins over free, except under the robot itself: where it stood, nothing else can have been.

    Args:
        scanned: What the scans tell.
        footprint: What the robot covers where it has stood.
        lasers: Hokuyo scans, each with the (4, 4) world_from_base at which it was taken.
        passing: Hokuyo scans taken under way: they tell of what is new in the room, and nothing else.
        robot_poses: (4, 4) world_from_base at which the robot has stood.
        scanner: What took the scans: its field of view and minimum range leave a disc around it blind.
    """
    parameters, scanner = parameters or GridParameters(), scanner or ScannerParameters()
    grid = scanned.grid
    for scan, world_from_base in lasers:
        grid = with_laser(grid, scan, world_from_base, parameters=parameters)
    grid = _with_news(grid, passing, parameters)
    cells = grid.cells.copy()
    for origin in np.asarray(scanned.scanners_in_world, dtype=np.float64):
        shadowed = _shadowed(grid, scanned.seen, origin, scanned.floor_height, scanner)
        cells[shadowed & (cells == Cell.FREE)] = Cell.UNKNOWN
    for world_from_base in robot_poses:
        cells[_under(grid, footprint, world_from_base)] = Cell.FREE
    return replace(grid, cells=cells)


def with_laser(
    grid: OccupancyGrid,
    scan: LaserScan,
    world_from_base: NDArray[np.float64],
    *,
    parameters: GridParameters | None = None,
) -> OccupancyGrid:
    """Add one Hokuyo scan: hits become occupied, unknown cells that beams crossed become free.

    Occupied cells stay so, whatever crosses them at the Hokuyo's height: they may block above or below it.
    """
    parameters = parameters or GridParameters()
    world_from_laser = world_from_base @ scan.base_from_laser
    ranges = np.where(np.isnan(scan.ranges), np.inf, scan.ranges)
    hits_in_world = transformed(scan.points_in_base(up_to=parameters.laser_hit_range), world_from_base)

    centres = grid.centres().reshape(-1, 2)
    offsets = np.column_stack([centres, np.full(len(centres), world_from_laser[2, 3])]) - world_from_laser[:3, 3]
    close = np.hypot(offsets[:, 0], offsets[:, 1]) <= parameters.laser_free_range
    in_laser = offsets[close] @ world_from_laser[:3, :3]
    bearing = np.arctan2(in_laser[:, 1], in_laser[:, 0])
    beam = np.rint(np.interp(bearing, scan.angles, np.arange(len(ranges)))).astype(np.intp)
    crossed = np.hypot(in_laser[:, 0], in_laser[:, 1]) < ranges[beam] - grid.resolution
    crossed &= (bearing >= scan.angles[0]) & (bearing <= scan.angles[-1])

    cells = grid.cells.copy()
    flat = cells.reshape(-1)
    free = np.flatnonzero(close)[crossed]
    flat[free[flat[free] == Cell.UNKNOWN]] = Cell.FREE
    row, column, inside = grid.indices(hits_in_world)
    cells[row[inside], column[inside]] = Cell.OCCUPIED
    return replace(grid, cells=cells)


def _with_news(
    grid: OccupancyGrid, passing: Sequence[tuple[LaserScan, NDArray[np.float64]]], parameters: GridParameters
) -> OccupancyGrid:
    """Add hits that are too far from all that is known to be that, put a little aside by a moving robot's pose.

    What the beams crossed is not made free: a table's top stands above their plane.
    """
    distance = cv2.distanceTransform((grid.cells != Cell.OCCUPIED).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    new = distance * grid.resolution > parameters.news_from
    cells = grid.cells.copy()
    for scan, world_from_base in passing:
        hits = transformed(scan.points_in_base(up_to=parameters.laser_hit_range), world_from_base)
        row, column, inside = grid.indices(hits)
        row, column = row[inside], column[inside]
        cells[row[new[row, column]], column[new[row, column]]] = Cell.OCCUPIED
    return replace(grid, cells=cells)


def _within_reach(
    points: NDArray[np.floating], scanners: NDArray[np.floating], floor_height: float, parameters: GridParameters
) -> NDArray[np.floating]:
    """Points between just under the floor and the robot's top, not too far from some scanner."""
    height = points[:, 2] - floor_height
    points = points[(height > -parameters.min_obstacle_height) & (height < parameters.robot_height)]
    near = np.zeros(len(points), dtype=np.bool_)
    for scanner in scanners:
        near |= ((points[:, :2] - scanner[:2]) ** 2).sum(axis=1) < parameters.reach**2
    return points[near]


def _empty_grid(
    points: NDArray[np.floating], scanners: NDArray[np.floating], parameters: GridParameters
) -> OccupancyGrid:
    """An unknown grid over the points and two metres around each scanner."""
    corners = np.concatenate([points[:, :2], scanners[:, :2] - 2.0, scanners[:, :2] + 2.0]).astype(np.float64)
    first = np.floor(corners.min(axis=0) / parameters.resolution)
    columns, rows = (np.floor(corners.max(axis=0) / parameters.resolution) - first + 1).astype(int)
    cells = np.zeros((rows, columns), dtype=np.uint8)
    return OccupancyGrid(origin=first * parameters.resolution, resolution=parameters.resolution, cells=cells)


def _count(grid: OccupancyGrid, points: NDArray[np.floating]) -> NDArray[np.intp]:
    row, column, inside = grid.indices(points)
    flat = (row * grid.cells.shape[1] + column)[inside]
    return np.bincount(flat, minlength=grid.cells.size).reshape(grid.cells.shape)


def _closed(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Gaps of a cell or two filled, as they lie between scan lines on a table top or on the floor far away."""
    return cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)) > 0


def _shadowed(
    grid: OccupancyGrid,
    floor: NDArray[np.bool_],
    origin: NDArray[np.float64],
    floor_height: float,
    scanner: ScannerParameters,
) -> NDArray[np.bool_]:
    """(rows, columns) cells of a scanner's blind disc in whose direction the floor beyond is missing unexplained.

    Something nearer than the minimum range swallowed those beams, and no known obstacle accounts for it.
    """
    height = origin[2] - floor_height
    blind = height / np.tan(-scanner.lowest_elevation)
    blind = float(max(blind, np.sqrt(max(scanner.min_range**2 - height**2, 0.0))))
    azimuths = np.radians(np.arange(0, 360, 2) + 1.0)
    radii = np.arange(grid.resolution, blind + 0.4, grid.resolution)
    rays = origin[:2] + radii[None, :, None] * np.stack([np.cos(azimuths), np.sin(azimuths)], axis=-1)[:, None]
    row, column, inside = grid.indices(rays)
    explained = (inside & (grid.cells[row, column] == Cell.OCCUPIED)).any(axis=1)
    beyond = radii > blind - 0.1
    lit = (inside & floor[row, column])[:, beyond].any(axis=1)
    suspect = ~explained & ~lit

    offsets = grid.centres() - origin[:2]
    azimuth = np.arctan2(offsets[..., 1], offsets[..., 0]) % (2 * np.pi)
    sector = np.minimum((azimuth / np.radians(2)).astype(np.intp), len(azimuths) - 1)
    return (np.hypot(offsets[..., 0], offsets[..., 1]) < blind) & suspect[sector] & ~floor


def _under(grid: OccupancyGrid, footprint: Footprint, world_from_base: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(rows, columns) cells whose centre lies under the robot."""
    in_base = (grid.centres().reshape(-1, 2) - world_from_base[:2, 3]) @ world_from_base[:2, :2]
    return footprint.covers(in_base).reshape(grid.cells.shape)
