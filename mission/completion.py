"""When a room is scanned: its doors, its exits, its place among the other rooms, and the comparison with the joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detector.detect import detect_doors
from mission.config import MissionConfig
from mission.door_faces import door_faces
from mission.evaluation import JudgedWall, evaluate, judged, placed
from mission.events import DoorsDetected, DoorsEvaluated, Event, RoomsTied
from mission.exits import find_exits
from mission.explored_building import CompletedRoom, ExploredBuilding
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.rigid import Pose, transformed
from mission.stopwatch import Stopwatch
from mission.structure import Structure
from mission.views import Views
from mission.voxels import VoxelModel, room_from

if TYPE_CHECKING:
    from sim.door_truth import DoorTruth

MOVED = 1e-3
"""Rooms that links move by less are not judged again [m]."""


class Completion:
    """Judges room after room, and tells of it in events. The true doors go into events only.

    Args:
        building: Completed rooms are added to it.
        footprint: Of the robot.
        config: Parameters of all stages.
        stopwatch: Counts the time of each stage.
        event: Makes the next event of a kind: `mission.surveyor.Surveyor.event`.
        true_doors: As they stand now.
    """

    def __init__(
        self,
        building: ExploredBuilding,
        footprint: Footprint,
        config: MissionConfig,
        stopwatch: Stopwatch,
        *,
        event: Callable[..., Any],
        true_doors: Callable[[], tuple[DoorTruth, ...]],
    ) -> None:
        self._building, self._footprint, self._config, self._stopwatch = building, footprint, config, stopwatch
        self._event, self._true_doors = event, true_doors
        self._walls: dict[int, tuple[JudgedWall, ...]] = {}
        self._compared_at: dict[int, Pose] = {}

    def complete(self, room: ExploredRoom, structure: Structure, voxels: VoxelModel) -> Iterator[Event]:
        """Hand the completed room to the detector; tie it to the others; compare its doors with the joints."""
        with self._stopwatch("detect"):
            views = Views(room.coloured, once=True)
            room.close()
            results = tuple(detect_doors(room_from(structure, voxels, views), self._config.detector))
        yield self._event(
            DoorsDetected,
            results=results,
            floor_height=structure.floor_height,
            ceiling_height=structure.ceiling_height,
        )
        with self._stopwatch("tie rooms"):
            faces = door_faces(results, room=room.number)
            exits, refused = find_exits(
                faces,
                room.points,
                floor_height=structure.floor_height,
                footprint=self._footprint,
                robot_height=self._config.navigation.grid.robot_height,
                parameters=self._config.navigation.exits,
            )
            self._building.complete(CompletedRoom(room, structure, faces, tuple(exits)))
            self._walls[room.number] = judged(results)
        del results
        yield self._event(
            RoomsTied,
            world_from_room=dict(self._building.world_from_room),
            links=tuple(self._building.links),
            faces=tuple(self._building.faces()),
            exits=tuple(way.face.door_id for way in exits),
            refused=tuple((face.door_id, why) for face, why in refused),
        )
        for number in self._building.rooms:
            if self._has_moved(number):
                yield self._evaluated(number)

    def _has_moved(self, number: int) -> bool:
        """Whether a room lies elsewhere than where its doors were compared with the true ones."""
        if number not in self._compared_at:
            return True
        corners = self._outline(number, self._building.world_from_room[number])
        return bool(np.abs(corners - self._outline(number, self._compared_at[number])).max() > MOVED)

    def _outline(self, number: int, world_from_room: Pose) -> NDArray[np.float64]:
        """(P, 2) of a room's floor in the world [m]."""
        polygon = self._building.rooms[number].structure.polygon
        in_room = np.column_stack([polygon, np.zeros(len(polygon))])
        return np.asarray(transformed(in_room, world_from_room)[:, :2], float)

    def _evaluated(self, number: int) -> DoorsEvaluated:
        """A room's doors, where they lie by now, beside the true ones."""
        with self._stopwatch("evaluate"):
            world_from_room = self._compared_at[number] = self._building.world_from_room[number]
            true_doors = self._true_doors()
            doors, missed = evaluate(
                placed(self._walls[number], world_from_room),
                true_doors,
                room=number,
                outline=self._outline(number, world_from_room),
            )
        evaluated: DoorsEvaluated = self._event(
            DoorsEvaluated, room=number, doors=doors, missed=missed, true_doors=true_doors
        )
        return evaluated
