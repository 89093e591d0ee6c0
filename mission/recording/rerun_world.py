"""The 3D world of the Rerun recording: the room as it is scanned, and the robot on its way."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.events import (
    DoorsDetected,
    Drove,
    Event,
    MissionFinished,
    MissionStarted,
    Pose,
    Registered,
    RoomEntered,
    RoomsTied,
    Structured,
)
from mission.recording import entities
from mission.recording.drawing import TRUTH_COLOUR, WALL_COLOUR, outline
from mission.recording.entities import child
from mission.recording.rerun_places import Places, log_pose
from mission.rigid import inverted, transformed

PATH_COLOUR = (255, 120, 40)
PLAN_COLOUR = (80, 200, 255)
LASER_COLOUR = (255, 60, 60)
ROOM_COLOUR = (235, 235, 235)
LIFT = 0.03
"""Lines on the floor are drawn this much above it, or the floor's points bury them [m]."""


class World:
    """Draws walls, the robot and its paths."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._scanner_from_base: Pose = np.eye(4)
        self._floor = 0.0
        self._scan_number = 0
        self._places = Places(rec)
        self._middles: dict[int, NDArray[np.float64]] = {}
        self._labelled: set[str] = set()

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
        self._places.follow(event)
        self._leave()
        log_pose(self._rec, entities.ROBOT, event.world_from_room @ event.world_from_base)

    @draw.register
    def _(self, event: RoomsTied) -> None:
        self._places.follow(event)

    @draw.register
    def _(self, event: MissionFinished) -> None:
        if len(self._middles) > 1:
            self._leave()

    def _leave(self) -> None:
        """Take the labels off what is in rooms that the robot has left; their names remain."""
        for entity in sorted(self._labelled):
            self._rec.log(entity, rr.Points3D.from_fields(show_labels=False))
        self._labelled.clear()
        for room, middle in self._middles.items():
            entity = child(entities.WALLS, room, "room")
            label = rr.Points3D([middle], labels=f"room {room}", colors=ROOM_COLOUR, radii=0.0, show_labels=True)
            self._rec.log(entity, label)

    @draw.register
    def _(self, event: Registered) -> None:
        self._scan_number = event.scan_number
        world_from_scanner = self._places[event.room] @ event.world_from_scanner
        log_pose(self._rec, entities.ROBOT, world_from_scanner @ self._scanner_from_base)
        self._places.belongs(child(entities.CLOUDS, f"{event.scan_number:03d}"), event.room)
        place = child(entities.CLOUDS, f"{event.scan_number:03d}", "scanner")
        self._labelled.add(place)
        log_pose(self._rec, place, event.world_from_scanner)
        self._rec.log(
            place,
            rr.TransformAxes3D(0.4),
            rr.Points3D(
                [(0, 0, 0)], radii=0.04, colors=PLAN_COLOUR, labels=f"scan {event.scan_number}", show_labels=True
            ),
            rr.AnyValues(fitness=event.fitness, rmse_m=event.rmse, accepted=event.accepted, reason=event.reason),
        )

    @draw.register
    def _(self, event: Structured) -> None:
        self._floor = event.structure.floor_height
        self._middles[event.room] = np.array([*event.structure.polygon.mean(axis=0), self._floor + LIFT])
        self._draw_walls(event.room, [outline(wall) for wall in event.structure.walls])

    @draw.register
    def _(self, event: DoorsDetected) -> None:
        self._draw_walls(event.room, [outline(result.wall) for result in event.results])

    @draw.register
    def _(self, event: Drove) -> None:
        self._drive(event)
        leg = f"{event.step:04d}"
        self._places.belongs(child(entities.DRIVEN, leg), event.room)
        self._path(child(entities.DRIVEN, leg), event.world_from_base[:, :2, 3], colour=PATH_COLOUR, radius=0.025)
        self._path(child(entities.TRUE_PATH, leg), event.true_world_from_base[:, :2, 3], colour=TRUTH_COLOUR)
        self._path(entities.PLANNED, self._in_world(event.room, event.planned_path), colour=PLAN_COLOUR, radius=0.012)
        self._draw_lasers(event)

    def _in_world(self, room: int, way: NDArray[np.float64]) -> NDArray[np.float64]:
        """(P, 2) places of a room's frame, in the world."""
        level = np.column_stack([way, np.zeros(len(way))])
        return np.asarray(transformed(level, self._places[room])[:, :2], float)

    def _drive(self, event: Drove) -> None:
        """The robot's poses, each at its own mission time."""
        count = len(event.times)
        poses = self._places[event.room] @ event.world_from_base
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

    def _draw_walls(self, room: int, outlines: list[NDArray[np.float64]]) -> None:
        names = [f"wall {entities.wall_name(room, number)}" for number in range(1, len(outlines) + 1)]
        entity = child(entities.WALLS, room)
        self._places.belongs(entity, room)
        sizes = np.array([np.linalg.norm(np.diff(line, axis=0), axis=1)[:2] for line in outlines]).reshape(-1, 2)
        self._rec.log(
            f"{entity}/outlines",
            rr.LineStrips3D(outlines, colors=WALL_COLOUR, radii=0.01),
            *hover(width_m=sizes[:, 0], height_m=sizes[:, 1]),
        )
        tops = [0.85 * line[3] + 0.15 * line[2] for line in outlines]  # left in the upper edge: doors are labelled, too
        self._labelled.add(f"{entity}/names")
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
            points.append(transformed(scan.points_in_base(), self._places[event.room] @ pose))
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
