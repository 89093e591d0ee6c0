"""The labelled voxels of a room: Occupied, Occluded and Opening on its surfaces, and Clutter (section 3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from detector.room import Room, View, VoxelLabel, Wall
from mission.by_columns import chosen, distinct, gathered
from mission.samples import PosedSample
from mission.structure import Structure
from mission.visibility import Visibility, VisibilityParameters
from mission.wall_finder import WallRectangle
from sim.parameters import Parameters
from sim.scan import ScannerParameters

Floats = NDArray[np.float64]
Labels = NDArray[np.uint8]

FLOOR = -1
"""In `VoxelModel.surfaces`: the floor."""
CEILING = -2
"""In `VoxelModel.surfaces`: the ceiling."""


class VoxelParameters(Parameters):
    """The grid, and what a voxel of a wall reaches."""

    size: float = Field(default=0.2, ge=0.05, le=0.5, description="side of a voxel: section 3 [m]")
    behind: float = Field(default=0.2, ge=0.01, le=1, description="a wall's voxel reaches this far behind its face [m]")
    before: float = Field(default=0.1, ge=0.01, le=1, description="a wall's voxel reaches this far into the room [m]")
    floor_clearance: float = Field(
        default=0.05, ge=0, le=0.5, description="below it points are floor or sill, not wall [m]"
    )
    max_incidence: float = Field(
        default=math.radians(78),
        gt=0,
        lt=math.pi / 2,
        description="seen flatter only, a wall's points are too far apart to show what is there [rad]",
    )
    level_reach: float = Field(default=0.08, ge=0.01, le=0.5, description="points this near are floor or ceiling [m]")
    visibility: VisibilityParameters = Field(default_factory=VisibilityParameters)


@dataclass(frozen=True, eq=False)
class LevelGrid:
    """The voxels of the floor or the ceiling, aligned with the longest wall."""

    origin: Floats
    """(3,) corner of cell (0, 0) in the world [m]."""
    u: Floats
    """(3,) unit vector along a row."""
    v: Floats
    """(3,) unit vector along a column."""
    labels: Labels
    """(rows, columns) `VoxelLabel`; 0 outside the room. Cell (r, c) is centred on (c + 0.5) u + (r + 0.5) v."""


@dataclass(frozen=True, eq=False)
class VoxelModel:
    """The labelled voxels of a room."""

    size: float
    """Side of a voxel [m]."""
    walls: tuple[Labels, ...]
    """Labels (rows, columns) of each wall of the structure, as in `detector.room.Wall.voxel_labels`."""
    floor: LevelGrid
    ceiling: LevelGrid | None
    clutter: Floats
    """(K, 3) centres of the voxels of a world-aligned grid that hold points of no structural element [m]."""
    cells_in_world: Floats
    """(M, 3) centres of all structural voxels, wall by wall, then floor, then ceiling, on the surface [m]."""
    normals: Floats
    """(M, 3) unit normals of their surfaces, into the room."""
    labels: Labels
    """(M,) their `VoxelLabel`."""
    areas: Floats
    """(M,) what of the voxel's face is on the surface [m2]."""
    surfaces: NDArray[np.int_]
    """(M,) index of the wall; FLOOR; CEILING."""

    @property
    def coverage(self) -> float:
        """Share of the walls' area that is not Occluded."""
        walls = self.surfaces >= 0
        areas = self.areas[walls]
        occluded = self.labels[walls] == VoxelLabel.OCCLUDED
        return 1.0 - float(areas[occluded].sum() / areas.sum()) if len(areas) else 1.0


def label_voxels(
    structure: Structure,
    scans: Sequence[PosedSample],
    parameters: VoxelParameters | None = None,
    *,
    scanner: ScannerParameters | None = None,
) -> VoxelModel:
    """Label the voxels of a room from all scans taken in it.

    Args:
        structure: Its walls, floor and ceiling.
        scans: Samples of all its scans.
        parameters: Sizes.
        scanner: What took the scans.
    """
    parameters = parameters or VoxelParameters()
    points = gathered([scan.points_in_world for scan in scans])
    number = np.repeat(np.arange(len(scans)), [len(scan.points_in_world) for scan in scans])
    visibility = Visibility(scans, scanner or ScannerParameters(), parameters.visibility)
    walls = [_wall_patch(wall, parameters) for wall in structure.walls]
    grids = _levels(structure, parameters)
    patches = walls + [patch for _, patch in grids]
    labels = [_labelled(patch, points, number, visibility, parameters) for patch in patches]
    levels = [
        LevelGrid(patch.corner, patch.u, patch.v, np.where(inside, level_labels, 0).astype(np.uint8))
        for (inside, patch), level_labels in zip(grids, labels[len(walls) :], strict=True)
    ]
    counted = [patch.areas > 0 for patch in patches]
    surfaces = [*range(len(walls)), FLOOR, CEILING][: len(patches)]
    return VoxelModel(
        size=parameters.size,
        walls=tuple(labels[: len(walls)]),
        floor=levels[0],
        ceiling=levels[1] if len(levels) > 1 else None,
        clutter=_clutter(structure, points, parameters),
        cells_in_world=_gathered([patch.centres(parameters.size) for patch in patches], counted),
        normals=_gathered([np.broadcast_to(patch.normal, (*patch.areas.shape, 3)) for patch in patches], counted),
        labels=_gathered(labels, counted),
        areas=_gathered([patch.areas for patch in patches], counted),
        surfaces=_gathered(
            [np.full(patch.areas.shape, n) for patch, n in zip(patches, surfaces, strict=True)], counted
        ),
    )


def room_from(structure: Structure, voxels: VoxelModel, views: Sequence[View]) -> Room:
    """The completed room as the detector takes it."""
    walls = tuple(
        Wall(
            origin=wall.origin,
            u=wall.u,
            v=wall.v,
            width=wall.width,
            height=wall.height,
            voxel_labels=labels,
            voxel_size=voxels.size,
        )
        for wall, labels in zip(structure.walls, voxels.walls, strict=True)
    )
    return Room(views=views, walls=walls, floor_height=structure.floor_height, ceiling_height=structure.ceiling_height)


@dataclass(frozen=True, eq=False)
class _Patch:
    """A plane surface in cells: cell (r, c) is centred (c + 0.5) u and (r + 0.5) v from the corner."""

    corner: Floats
    u: Floats
    v: Floats
    normal: Floats
    areas: Floats
    """(rows, columns) what of each cell counts [m2]."""
    behind: float
    before: float
    clearance: float
    """Points farther than this along v do not count [m]."""

    def along(self, points: Floats, axis: Floats) -> Floats:
        """(N,) of points (N, 3) along u, v or the normal, from the corner [m]."""
        x, y, z = (points - self.corner).T
        return x * axis[0] + y * axis[1] + z * axis[2]

    def centres(self, size: float) -> Floats:
        """(rows, columns, 3) in the world [m]."""
        rows, columns = self.areas.shape
        return (
            self.corner
            + (np.arange(columns)[None, :, None] + 0.5) * size * self.u
            + (np.arange(rows)[:, None, None] + 0.5) * size * self.v
        )


def _wall_patch(wall: WallRectangle, parameters: VoxelParameters) -> _Patch:
    """From the top left corner, rows downwards; the last row and column may stick out."""
    size = parameters.size
    return _Patch(
        corner=wall.origin + wall.height * wall.v,
        u=wall.u,
        v=-wall.v,
        normal=wall.normal,
        areas=np.outer(_extents(wall.height, size), _extents(wall.width, size)),
        behind=parameters.behind,
        before=parameters.before,
        clearance=wall.height - parameters.floor_clearance,
    )


def _extents(length: float, size: float) -> Floats:
    """What of each cell is within the length [m]; the last one may be shorter, but a centimetre gets no cell."""
    count = max(1, int(np.ceil(length / size - 0.05)))
    return np.minimum(size, length - size * np.arange(count))


def _levels(structure: Structure, parameters: VoxelParameters) -> list[tuple[NDArray[np.bool_], _Patch]]:
    """Patches of floor and ceiling over the polygon's bounding rectangle, and which cells are of the room."""
    size = parameters.size
    longest = max(structure.walls, key=lambda wall: wall.width)
    u = longest.u
    v = np.array([-u[1], u[0], 0.0])
    along = np.stack([structure.polygon[:, 0] * a[0] + structure.polygon[:, 1] * a[1] for a in (u, v)], axis=1)
    low, high = along.min(axis=0), along.max(axis=0)
    counts = np.ceil((high - low) / size - 0.05).astype(int)
    found = []
    heights = [structure.floor_height] + ([] if structure.ceiling_height is None else [structure.ceiling_height])
    for height, up in zip(heights, (1.0, -1.0), strict=False):
        corner = low[0] * u + low[1] * v + np.array([0, 0, height])
        reach = parameters.level_reach
        normal = np.array([0, 0, up])
        patch = _Patch(corner, u, v, normal, np.full(counts[::-1], size**2), reach, reach, np.inf)
        inside = structure.interior(patch.centres(size).reshape(-1, 3)[:, :2]).reshape(counts[::-1])
        patch.areas[~inside] = 0
        found.append((inside, patch))
    return found


def _labelled(
    patch: _Patch, points: Floats, number: NDArray[np.int_], visibility: Visibility, parameters: VoxelParameters
) -> Labels:
    """(rows, columns) Occupied with a point; else Opening if some scan looked through; else Occluded.

    A wall's voxel with points of grazing beams only is Occluded: a few lines of points show no door.
    """
    scanners = np.array([scan.scanner_in_world for scan in visibility.scans])
    occupied, grazed = _filled(patch, points, number, scanners, parameters)
    empty = ~occupied & ~grazed & (patch.areas > 0)
    labels = np.where(occupied, VoxelLabel.OCCUPIED, VoxelLabel.OCCLUDED).astype(np.uint8)
    through = _looked_through(patch, empty, visibility, parameters.size)
    labels[empty] = np.where(through, VoxelLabel.OPENING, VoxelLabel.OCCLUDED)
    return labels


def _filled(
    patch: _Patch, points: Floats, number: NDArray[np.int_], scanners: Floats, parameters: VoxelParameters
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Cells (rows, columns) with a point, and those with points of grazing beams only.

    Point n (N, 3) is of the scan with `number[n]`, whose beams began at that row of `scanners` (S, 3).
    """
    rows, columns = patch.areas.shape
    depth = patch.along(points, patch.normal)
    near = np.flatnonzero((depth > -patch.behind) & (depth < patch.before))
    points, number = chosen(points, near), number[near]
    across = patch.along(points, patch.v)
    cell = np.floor(np.stack([across, patch.along(points, patch.u)]) / parameters.size).astype(int)
    within = ((cell >= 0) & (cell < [[rows], [columns]])).all(axis=0) & (across < patch.clearance)
    cell = cell[:, within]
    grazing = np.zeros(cell.shape[1], bool)
    if abs(patch.normal[2]) < 0.5:
        beams = scanners[number[within]] - points[within]
        steepness = np.abs(beams @ patch.normal) / np.sqrt(np.sum(beams**2, axis=1))
        grazing = steepness < np.cos(parameters.max_incidence)
    occupied, met = np.zeros((rows, columns), bool), np.zeros((rows, columns), bool)
    occupied[tuple(cell[:, ~grazing])] = True
    met[tuple(cell)] = True
    return occupied, met & ~occupied


def _looked_through(patch: _Patch, cells: NDArray[np.bool_], visibility: Visibility, size: float) -> NDArray[np.bool_]:
    """Cells (K,) of which some scan looked through most of five places: the centre and four round it."""
    centres = patch.centres(size)[cells]
    offsets = size / 4 * np.array([(0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)], float)
    places = centres[:, None] + offsets[:, :1] * patch.u + offsets[:, 1:] * patch.v
    normals = np.broadcast_to(patch.normal, (places.shape[0] * 5, 3))
    passed = visibility.looked_through(places.reshape(-1, 3), normals, behind=patch.behind)
    return (passed.reshape(len(visibility.scans), len(centres), 5).sum(axis=2) >= 3).any(axis=0)


def _clutter(structure: Structure, points: Floats, parameters: VoxelParameters) -> Floats:
    """(K, 3) centres of world-aligned voxels with points that are inside and off every surface."""
    reach = parameters.level_reach
    high = np.inf if structure.ceiling_height is None else structure.ceiling_height
    inside = chosen(points, (points[:, 2] > structure.floor_height + reach) & (points[:, 2] < high - reach))
    inside = chosen(inside, structure.interior(inside))
    for wall in structure.walls:
        patch = _wall_patch(wall, parameters)
        along, depth = patch.along(inside, patch.u), patch.along(inside, patch.normal)
        inside = chosen(inside, (depth > patch.before) | (depth < -patch.behind) | (along < 0) | (along > wall.width))
    return parameters.size * (distinct(np.floor(inside / parameters.size).astype(int)) + np.float64(0.5))


def _gathered(grids: Sequence[NDArray[Any]], counted: Sequence[NDArray[np.bool_]]) -> NDArray[Any]:
    """What counts of each grid, in one array."""
    return np.concatenate([grid[which] for grid, which in zip(grids, counted, strict=True)])
