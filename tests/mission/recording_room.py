"""A made-up room for the recordings' tests: its walls, what a scan and the detector made of them, its true doors.

It is 6 x 4.5 x 2.7 m with a corner in the origin. Wall 2 has a door open by 30 deg whose joint stands at 31 deg, wall 3
a closed one, and wall 4 a sliding door that the detector missed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.metrics import overlap
from detector.result import (
    Candidate,
    Door,
    DoorSearch,
    Highlights,
    Leaf,
    Openings,
    Orthoimage,
    Rectangle,
    WallArea,
    WallResult,
)
from detector.room import View, VoxelLabel, Wall
from mission.candidates import ScanCandidate
from mission.door_faces import DoorFace
from mission.evaluation import DoorEvaluation
from mission.grid import Cell, OccupancyGrid
from mission.planning import Plan
from mission.pose_graph import Link
from mission.structure import Structure
from mission.voxels import FLOOR, LevelGrid, VoxelModel
from mission.wall_finder import WallRectangle
from sim.door_truth import DoorTruth, LeafTruth
from sim.photo import Photo

ROWS, COLUMNS, PIXEL = 60, 100, 0.045
"""Orthoimages of 4.5 x 2.7 m."""
ESTIMATE, JOINT = np.radians(30.0), np.radians(31.0)


def pose(x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> NDArray[np.float64]:
    """World from something that stands upright."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


def walls() -> tuple[Wall, ...]:
    """Four walls, counter-clockwise from above, each seen from inside: its u points to the viewer's right."""
    corners = np.array([[0, 0], [6, 0], [6, 4.5], [0, 4.5]], float)
    made = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        width = float(np.linalg.norm(end - start))
        labels = np.full((14, round(width / 0.2 + 0.49)), VoxelLabel.OCCUPIED, np.uint8)
        labels[5:, 3:7] = VoxelLabel.OPENING
        right = np.array([*(start - end) / width, 0.0])  # inside is to the left of start -> end
        made.append(Wall(np.array([*end, 0.0]), right, np.array([0, 0, 1.0]), width, 2.7, labels))
    return tuple(made)


def view(rng: np.random.Generator, count: int = 2000) -> View:
    """Points on floor, ceiling and walls; one in ten uncoloured."""
    points = rng.uniform(0, 1, (count, 3)) * [6, 4.5, 2.7]
    axis = rng.integers(0, 3, count)
    points[np.arange(count), axis] = rng.integers(0, 2, count) * np.array([6, 4.5, 2.7])[axis]
    colours = (60 + 190 * points / [6, 4.5, 2.7]).astype(np.uint8)
    coloured = np.arange(count) % 10 != 0
    centre = np.array([3.0, 2.0, 1.2])
    return View(points.astype(np.float32), colours, coloured, centre, centre + [0, 0, 0.2])


def door(*, angle: float) -> Door:
    """A single door, hinged on the left."""
    leaf = Leaf("left", angle, np.radians(0.4), "inward" if angle else None, np.zeros((0, 2), np.float32))
    return Door(Rectangle(1.0, 0.0, 1.9, 2.1), "single", "semi-open" if angle else "closed", (leaf,))


def wall_result(wall: Wall, doors: tuple[Door, ...]) -> WallResult:
    """A wall with all its stages, in small images."""
    shape = (ROWS, COLUMNS)
    inside = np.zeros(shape, bool)
    inside[14:, 22:42] = True  # the doorway: 1.0 to 1.9 m, up to 2.1 m
    colour = np.full((*shape, 3), (220, 215, 200), np.uint8)
    colour[inside] = (120, 80, 40)
    ortho = Orthoimage(colour, np.ones(shape, bool), np.where(inside, np.nan, 0.002).astype(np.float32), PIXEL)
    spot = np.zeros(shape, bool)
    spot[10:16, 60:70] = True
    contour = np.array([[10, 60], [9, 65], [10, 70], [13, 71], [16, 70], [17, 65], [16, 60], [13, 59]], float)
    highlights = Highlights(spot, colour[:, :, 0], spot.astype(np.int32), spot, (contour,), colour)
    lines = np.array([14, 59], np.int32), np.array([22, 41], np.int32)
    openings = Openings(
        trinary=inside.astype(np.uint8) + 1,
        horizontal_lines=lines[0],
        vertical_lines=lines[1],
        clusters=np.zeros((14, 23), np.int32),
        rectangles=tuple(found.rectangle for found in doors),
        is_door=tuple(True for _ in doors),
        visibility=inside.astype(np.uint8) + 1,
    )
    seeds = np.array([[0, 0], [0, 50], [20, 80]], np.int32)
    area = WallArea(seeds, np.array([1, 1, 0], np.int32), (~inside).astype(np.int32), ~inside)
    edges = np.zeros(shape, bool)
    edges[14:, 22] = edges[14:, 41] = edges[14, 22:42] = True
    judged = [Candidate(d.rectangle, 0.9, 0.8, (1.0, 0.9, 0.8, 1.0), 0.01, None) for d in doors]
    judged += [Candidate(Rectangle(2.5, 0.0, 3.2, 2.0), 0.2, 0.3, (0.2, 0.1, 0.4, 1.0), 0.9, "colour")]
    search = DoorSearch(edges, edges, edges, *lines, tuple(judged))
    seconds = (("orthoimages", 0.1), ("highlights", 0.4))
    return WallResult(wall, (ortho,), (0,), (highlights,), ortho, openings, area, search, doors, seconds)


def evaluation(wall: Wall, number: int, found: Door, *, name: str | None, angle: float | None) -> DoorEvaluation:
    """A detected door beside its joint; the true leaf is a little taller."""
    r, depth = found.rectangle, np.sin(found.opening_angle) * 0.9
    doorway = np.array([[r.left, 0, 0], [r.right, 0, 0], [r.right, r.top, 0], [r.left, r.top, 0]], float)
    free = r.left + 0.9 * np.cos(found.opening_angle)
    leaf = np.array([[r.left, 0, 0], [free, 0, depth], [free, r.top, depth], [r.left, r.top, 0]])
    return DoorEvaluation(
        door_id=f"1.{number}-a",
        wall=number,
        door=found,
        corners_in_world=wall.world_from_wall(doorway),
        leaf_corners_in_world=(wall.world_from_wall(leaf),),
        true_name=name,
        true_angle=angle,
        overlap=None if name is None else overlap(r, r),
        true_leaf_corners_in_world=() if name is None else (wall.world_from_wall(leaf * [1, 1.01, 1.1]),),
    )


def true_door(name: str, wall: Wall, *, angle: float = np.nan, way: float = np.nan) -> DoorTruth:
    """A doorway from 1 to 1.9 m along a wall, hinged with an angle or sliding with a way; drawn closed."""
    corners = wall.world_from_wall(np.array([[1, 0, 0], [1.9, 0, 0], [1.9, 2.1, 0], [1, 2.1, 0]], float))
    leaf = LeafTruth(
        name=name,
        opening_angle=angle,
        opening=way,
        swing_normal=wall.normal,
        corners_in_world=corners,
    )
    kind = "hinged" if np.isnan(way) else "sliding"
    return DoorTruth(name, kind, (name,), corners, wall.normal, (corners, corners), (leaf,))


def photo() -> Photo:
    """A picture towards +x of the scanner, 120 x 80 px."""
    image = np.zeros((80, 120, 3), np.uint8)
    image[:, :, 0], image[:, :, 2] = np.arange(120) * 2, 90
    forward = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, 0, 1.0]])  # optical: z ahead, y down
    return Photo(image, np.array([[80, 0, 60], [0, 80, 40], [0, 0, 1.0]]), forward, np.zeros((80, 120), bool))


def structure() -> Structure:
    """Floor, ceiling and the four walls."""
    rectangles = tuple(WallRectangle(w.origin, w.u, w.v, w.width, w.height) for w in walls())
    polygon = np.array([[0, 0], [6, 0], [6, 4.5], [0, 4.5]], float)
    return Structure(0.0, 2.7, rectangles, polygon, np.arange(4))


def voxels() -> VoxelModel:
    """Wall 1 has one row of four voxels, one of them occluded; the floor has one voxel."""
    cells = np.array([[0.1, 0, 1], [0.3, 0, 1], [0.5, 0, 1], [0.7, 0, 1], [3, 2, 0]])
    normals = np.array([[0, 1, 0]] * 4 + [[0, 0, 1]], float)
    labels = np.array([1, 1, 3, 2, 1], np.uint8)
    floor = LevelGrid(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.ones((22, 30), np.uint8))
    grids = tuple(wall.voxel_labels for wall in walls())
    clutter = np.array([[2.0, 3.0, 0.5]])
    surfaces = np.array([0, 0, 0, 0, FLOOR])
    return VoxelModel(0.2, grids, floor, None, clutter, cells, normals, labels, np.full(5, 0.04), surfaces)


def plan(*, last: bool) -> Plan:
    """Twelve candidates on a raster; number 7 is chosen unless the room is done."""
    candidates = tuple(
        ScanCandidate(
            position=np.array([1.0 + i // 3, 1.0 + i % 3]),
            heading=0.3,
            gain=float(i),
            quality=1.0,
            doorway=0.5,
            overlap=0.5,
            travel=1.0,
            score=0.1 * i,
            reason=None if i else "blind",
        )
        for i in range(12)
    )
    way = None if last else np.array([[2, 2], [4, 2]], float)
    reason = "coverage" if last else None
    return Plan(candidates=candidates, chosen=None if last else 7, path=way, stop_reason=reason, coverage=0.9)


def grid() -> OccupancyGrid:
    """Free but for the lowest row, which is occupied, and the leftmost column, which is unknown."""
    cells = np.full((45, 60), Cell.FREE, np.uint8)
    cells[0], cells[:, 0] = Cell.OCCUPIED, Cell.UNKNOWN
    return OccupancyGrid(np.zeros(2), 0.1, cells)


def link() -> Link:
    """The hall's door, seen from room 1 and from room 2, whose frame lies 10 cm further along x."""
    return Link(
        first=1,
        second=2,
        in_first=np.array([2.0, 4.1, 2.1]),
        in_second=np.array([1.9, 4.1, 2.1]),
        turn=0.0,
        axes=np.eye(3),
        deviations=np.array([0.003, 0.005, 0.006]),
        turn_deviation=0.0005,
        doors=("1.2-a", "2.4-a"),
    )


def faces(wall: Wall, found: Door) -> tuple[DoorFace, DoorFace]:
    """The hall's door from room 1 and from room 2."""
    return DoorFace("1.2-a", 1, wall, found, np.nan), DoorFace("2.4-a", 2, wall, found, np.nan)
