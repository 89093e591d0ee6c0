"""A small mission made by hand, with every kind of event: what the recordings' tests tell and read back.

The room is 6 x 4.5 x 2.7 m with a corner in the origin. Wall 2 has a door open by 30 deg whose joint stands at 31 deg,
wall 3 has a closed one; a third true door is missed.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

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
from mission import events
from mission.evaluation import DoorEvaluation

SECOND = 1_000_000_000
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


def true_door(name: str, wall: Wall, angle: float) -> Any:
    """What the recordings read of a `sim.doors.DoorTruth`."""
    corners = wall.world_from_wall(np.array([[1, 0, 0], [1.9, 0, 0], [1.9, 2.1, 0], [1, 2.1, 0]], float))
    leaf = SimpleNamespace(name=name, opening_angle=angle, opening=np.nan, corners_in_world=corners)
    return SimpleNamespace(name=name, kind="hinged", leaves=(leaf,), corners_in_world=corners, leaf_names=(name,))


def photo() -> Any:
    """A picture towards +x of the scanner, 120 x 80 px."""
    image = np.zeros((80, 120, 3), np.uint8)
    image[:, :, 0], image[:, :, 2] = np.arange(120) * 2, 90
    forward = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, 0, 1.0]])  # optical: z ahead, y down
    return SimpleNamespace(
        image=image, intrinsics=np.array([[80, 0, 60], [0, 80, 40], [0, 0, 1.0]]), scanner_from_camera=forward
    )


def story(count: int = 2000) -> list[events.Event]:
    """Two scans, a drive between them, detection, evaluation, the end."""
    rng = np.random.default_rng(5)
    told: list[events.Event] = []

    def tell(kind: type[events.Event], seconds: float, **fields: Any) -> None:
        told.append(kind(step=len(told), time=int(seconds * SECOND), **fields))

    room, mount = walls(), pose(0, 0, 1.2)
    truth = (
        true_door("hall/door 1", room[1], JOINT),
        true_door("store", room[2], 0.0),
        true_door("lift", room[3], 0.5),
    )
    triangle = np.array([[0.3, 0, 0.2], [-0.3, 0.3, 0.2], [-0.3, -0.3, 0.2], [0, 0, 1.2]], np.float32)
    robot = SimpleNamespace(
        vertices=triangle,
        triangles=np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32),
        colours=np.full((4, 3), 90, np.uint8),
    )
    tell(
        events.MissionStarted,
        0,
        scene="made_up.xml",
        scene_xml="<mujoco/>",
        seed=3,
        config={"scanner": {"noise": True}},
        versions={"numpy": np.__version__},
        world_from_base=pose(2, 2),
        robot=robot,
        base_from_scanner=mount,
        true_doors=truth,
    )
    for number, x in ((1, 2.0), (2, 4.0)):
        tell_scan(tell, number, pose(x, 2) @ mount, rng=rng, count=count, seconds=80.0 * number)
        tell_plan(tell, number, room, last=number == 2, seconds=80.0 * number + 10)
        if number == 1:
            tell_drive(tell)
    tell(events.Remarked, 171, level="warning", text='the store\'s door is "shut"')
    doors = ((), (door(angle=ESTIMATE),), (door(angle=0.0),), ())
    results = tuple(wall_result(wall, found) for wall, found in zip(room, doors, strict=True))
    tell(events.DoorsDetected, 172, results=results, floor_height=0.0, ceiling_height=2.7)
    judged = (
        evaluation(room[1], 2, doors[1][0], name="hall/door 1", angle=JOINT),
        evaluation(room[2], 3, doors[2][0], name="store", angle=0.0),
    )
    tell(events.DoorsEvaluated, 172, doors=judged, missed=("lift",))
    tell(events.MissionFinished, 172, outcome="completed", reason="one room")
    return told


def tell_scan(tell: Any, number: int, place: NDArray, *, rng: np.random.Generator, count: int, seconds: float) -> None:
    """Scan, photographs, registration, colours."""
    grid = SimpleNamespace(
        elevations=np.linspace(0.5, -0.5, 20),
        azimuths=np.linspace(0, 6.2, 30),
        ranges=rng.uniform(2, 4, (20, 30)).astype(np.float32),
        reflectance=np.full((20, 30), -5, np.float32),
        duration=80.0,
    )
    grid.ranges[3, 4] = np.nan
    tell(events.Scanned, seconds, scan_number=number, scan=grid, true_world_from_scanner=place)
    tell(events.Photographed, seconds + 5, scan_number=number, photos=(photo(), photo()))
    tell(
        events.Registered,
        seconds + 5,
        scan_number=number,
        guess_world_from_scanner=place @ pose(0.01, 0),
        world_from_scanner=place,
        fitness=0.97,
        rmse=0.004,
        accepted=True,
        reason="fits",
        true_world_from_scanner=place,
    )
    tell(events.Coloured, seconds + 5, scan_number=number, view=view(rng, count))


def tell_plan(tell: Any, number: int, room: tuple[Wall, ...], *, last: bool, seconds: float) -> None:
    """Structure, voxels, plan."""
    structure = SimpleNamespace(
        floor_height=0.0, ceiling_height=2.7, walls=room, polygon=np.array([[0, 0], [6, 0], [6, 4.5], [0, 4.5]], float)
    )
    tell(events.Structured, seconds, scan_number=number, structure=structure)
    voxels = SimpleNamespace(coverage=0.8 + 0.1 * number, walls=tuple(wall.voxel_labels for wall in room))
    tell(events.Labelled, seconds, scan_number=number, voxels=voxels)
    places = [np.array([1.0 + x, 1.0 + y]) for x in range(4) for y in range(3)]
    candidates = tuple(
        SimpleNamespace(
            position=p,
            heading=0.3,
            gain=float(i),
            overlap=0.5,
            travel=1.0,
            score=0.1 * i,
            reason=None if i else "blind",
        )
        for i, p in enumerate(places)
    )
    plan = SimpleNamespace(
        candidates=candidates,
        chosen=None if last else 7,
        stop_reason="coverage" if last else None,
        coverage=voxels.coverage,
    )
    cells = np.ones((45, 60), np.uint8)
    cells[0], cells[:, 0] = 2, 0
    grid = SimpleNamespace(origin=np.zeros(2), resolution=0.1, cells=cells)
    tell(events.Planned, seconds, scan_number=number, plan=plan, grid=grid)


def tell_drive(tell: Any) -> None:
    """Two metres ahead in five seconds; the wheels believe a centimetre more."""
    times = np.linspace(95, 100, 26)
    true = np.array([pose(2 + 0.4 * (t - 95), 2) for t in times])
    angles = np.tile([JOINT, 0.0, 0.5], (26, 1))
    laser = SimpleNamespace(
        base_from_laser=pose(0.4, 0, 0.3),
        angles=np.linspace(-2, 2, 682),
        ranges=np.full(682, 1.5, np.float32),
        time=int(times[-1] * SECOND),
    )
    laser.ranges[::7] = np.nan
    tell(
        events.Drove,
        100,
        planned_path=np.array([[2, 2], [4, 2]], float),
        times=(times * SECOND).astype(np.int64),
        world_from_base=true + pose(0.01, 0) - np.eye(4),
        laser_scans=(laser,),
        arrived=True,
        reason="arrived",
        true_world_from_base=true,
        true_door_angles=angles,
    )
