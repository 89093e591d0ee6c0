"""The 3D world of the Rerun recording: the room as it is scanned, and the robot on its way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatchmethod
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.events import (
    Coloured,
    DoorsDetected,
    Drove,
    Event,
    MissionStarted,
    Pose,
    Registered,
    RoomEntered,
    RoomsTied,
    Structured,
)
from mission.recording import entities
from mission.recording.drawing import TRUTH_COLOUR, WALL_COLOUR, display_colours, on_grid, outline, thin
from mission.recording.entities import child
from mission.recording.room_frames import RoomFrames
from mission.rigid import inverted, transformed

PATH_COLOUR = (255, 120, 40)
PLAN_COLOUR = (80, 200, 255)
LASER_COLOUR = (255, 60, 60)
LIFT = 0.03
"""Lines on the floor are drawn this much above it, or the floor's points bury them [m]."""


def log_pose(rec: rr.RecordingStream, entity: str, world_from_x: Pose) -> None:
    """Log where something stands."""
    rec.log(entity, rr.Transform3D(translation=world_from_x[:3, 3], mat3x3=world_from_x[:3, :3]))


@dataclass
class _Cloud:
    """A scan thinned for display, waiting for the ceiling to be known."""

    scan_number: int
    points: NDArray[np.float32]
    colours: NDArray[np.uint8]


class World:
    """Draws clouds, walls, the robot and its paths."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._ceilings: dict[int, float] = {}
        self._waiting: _Cloud | None = None
        self._scanner_from_base: Pose = np.eye(4)
        self._floor = 0.0
        self._scan_number = 0
        self._frames = RoomFrames()
        self._in_room: dict[str, int] = {}

    @singledispatchmethod
    def draw(self, event: Event) -> None:
        """Draw one event; most have no place in the world."""

    @draw.register
    def _(self, event: MissionStarted) -> None:
        self._scanner_from_base = inverted(event.base_from_scanner)
        self._rec.log(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        robot = event.robot
        self._rec.log(
            entities.ROBOT_BODY,
            rr.Mesh3D(vertex_positions=robot.vertices, triangle_indices=robot.triangles, vertex_colors=robot.colours),
            static=True,
        )
        log_pose(self._rec, entities.ROBOT, event.world_from_base)

    @draw.register
    def _(self, event: RoomEntered) -> None:
        self._frames.follow(event)
        log_pose(self._rec, entities.ROBOT, event.world_from_room @ event.world_from_base)

    @draw.register
    def _(self, event: RoomsTied) -> None:
        """Move what was drawn in the rooms' frames to where the rooms lie by now."""
        moved = self._frames.follow(event)
        for entity, room in self._in_room.items():
            if room in moved:
                log_pose(self._rec, entity, moved[room])

    @draw.register
    def _(self, event: Registered) -> None:
        self._scan_number = event.scan_number
        world_from_scanner = self._frames[event.room] @ event.world_from_scanner
        log_pose(self._rec, entities.ROBOT, world_from_scanner @ self._scanner_from_base)
        self._belongs(child(entities.CLOUDS, f"{event.scan_number:03d}"), event.room)
        place = child(entities.CLOUDS, f"{event.scan_number:03d}", "scanner")
        log_pose(self._rec, place, event.world_from_scanner)
        self._rec.log(
            place,
            rr.TransformAxes3D(0.4),
            rr.Points3D([(0, 0, 0)], radii=0.04, colors=PLAN_COLOUR, labels=f"scan {event.scan_number}"),
            rr.AnyValues(fitness=event.fitness, rmse_m=event.rmse, accepted=event.accepted, reason=event.reason),
        )

    @draw.register
    def _(self, event: Coloured) -> None:
        view = event.view
        chosen = thin(view.points_in_world)
        points = on_grid(view.points_in_world[chosen])
        colours = display_colours(view.colours[chosen], view.coloured[chosen])
        self._waiting = _Cloud(event.scan_number, points, colours)
        self._draw_cloud(event.room)

    @draw.register
    def _(self, event: Structured) -> None:
        structure = event.structure
        self._floor = structure.floor_height
        if structure.ceiling_height is not None:
            self._ceilings.setdefault(event.room, structure.ceiling_height)
        if self._waiting:  # the first scan of a room is drawn again, for now the ceiling is known
            self._draw_cloud(event.room)
            self._waiting = None
        self._draw_walls(event.room, [outline(wall) for wall in structure.walls])

    @draw.register
    def _(self, event: DoorsDetected) -> None:
        self._draw_walls(event.room, [outline(result.wall) for result in event.results])

    @draw.register
    def _(self, event: Drove) -> None:
        self._drive(event)
        leg = f"{event.step:04d}"
        self._belongs(child(entities.DRIVEN, leg), event.room)
        self._path(child(entities.DRIVEN, leg), event.world_from_base[:, :2, 3], colour=PATH_COLOUR, radius=0.025)
        self._path(child(entities.TRUE_PATH, leg), event.true_world_from_base[:, :2, 3], colour=TRUTH_COLOUR)
        self._path(entities.PLANNED, self._in_world(event.room, event.planned_path), colour=PLAN_COLOUR, radius=0.012)
        self._draw_lasers(event)

    def _in_world(self, room: int, way: NDArray[np.float64]) -> NDArray[np.float64]:
        """(P, 2) places of a room's frame, in the world."""
        level = np.column_stack([way, np.zeros(len(way))])
        return np.asarray(transformed(level, self._frames[room])[:, :2], float)

    def _belongs(self, entity: str, room: int) -> None:
        """Draw an entity in the frame of a room."""
        if entity not in self._in_room:
            self._in_room[entity] = room
            pose = self._frames[room]
            if not np.array_equal(pose, np.eye(4)):
                log_pose(self._rec, entity, pose)

    def _drive(self, event: Drove) -> None:
        """The robot's poses, each at its own mission time."""
        count = len(event.times)
        poses = self._frames[event.room] @ event.world_from_base
        self._rec.send_columns(
            entities.ROBOT,
            [
                rr.TimeColumn("step", sequence=np.full(count, event.step)),
                rr.TimeColumn("mission_time", duration=event.times.astype("timedelta64[ns]")),
                rr.TimeColumn("scan", sequence=np.full(count, self._scan_number)),
                rr.TimeColumn("room", sequence=np.full(count, event.room)),
            ],
            rr.Transform3D.columns(
                translation=poses[:, :3, 3],
                mat3x3=poses[:, :3, :3].transpose(0, 2, 1).reshape(count, 9),  # column by column
            ),
        )

    def _draw_cloud(self, room: int) -> None:
        assert self._waiting is not None
        cloud, ceiling = self._waiting, self._ceilings.get(room)
        number = f"{cloud.scan_number:03d}"
        below = np.ones(len(cloud.points), bool) if ceiling is None else cloud.points[:, 2] < ceiling - 0.1
        entity = child(entities.CLOUDS, number, "points")
        self._log_points(entity, cloud.points[below], cloud.colours[below])
        if ceiling is not None:
            self._belongs(child(entities.CEILINGS, number), room)
            self._log_points(child(entities.CEILINGS, number), cloud.points[~below], cloud.colours[~below])
            self._waiting = None

    def _log_points(self, entity: str, points: NDArray[np.float32], colours: NDArray[np.uint8]) -> None:
        self._rec.log(entity, rr.Points3D(points, colors=colours, radii=rr.Radius.ui_points(1.5)))

    def _draw_walls(self, room: int, outlines: list[NDArray[np.float64]]) -> None:
        names = [f"wall {entities.wall_name(room, number)}" for number in range(1, len(outlines) + 1)]
        entity = child(entities.WALLS, room)
        self._belongs(entity, room)
        self._rec.log(f"{entity}/outlines", rr.LineStrips3D(outlines, colors=WALL_COLOUR, radii=0.01))
        tops = [0.85 * line[3] + 0.15 * line[2] for line in outlines]  # left in the upper edge: doors are labelled, too
        self._rec.log(
            f"{entity}/names", rr.Points3D(tops, labels=names, colors=WALL_COLOUR, radii=0.0, show_labels=True)
        )

    def _draw_lasers(self, event: Drove) -> None:
        """What the Hokuyos saw last."""
        if not event.laser_scans or not len(event.times):
            return
        points = []
        for scan in (scan for scan in event.laser_scans if scan.time == event.laser_scans[-1].time):
            pose = event.world_from_base[min(int(np.searchsorted(event.times, scan.time)), len(event.times) - 1)]
            points.append(transformed(scan.points_in_base(), self._frames[event.room] @ pose))
        self._rec.log(
            entities.LASERS, rr.Points3D(np.concatenate(points), colors=LASER_COLOUR, radii=rr.Radius.ui_points(1.5))
        )

    def _path(
        self, entity: str, way: NDArray[np.float64], *, colour: tuple[int, int, int], radius: float = 0.008
    ) -> None:
        line = np.column_stack([way, np.full(len(way), self._floor + LIFT)])
        self._rec.log(entity, rr.LineStrips3D([line], colors=colour, radii=radius))


def hover(**columns: Any) -> list[rr.AnyValues]:
    """Values that the viewer shows under the pointer, a row an instance; nothing where there is no row.

    Rerun refuses columns without a row.
    """
    return [rr.AnyValues(**columns)] if any(len(column) for column in columns.values()) else []
