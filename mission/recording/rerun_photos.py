"""Photographs in the Rerun recording, and the doors where they are to be seen in them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatchmethod
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from mission.evaluation import DoorEvaluation
from mission.events import (
    DoorsDetected,
    DoorsEvaluated,
    Drove,
    Event,
    MissionStarted,
    Photographed,
    Registered,
    RoomEntered,
    RoomsTied,
)
from mission.recording import entities
from mission.recording.drawing import TRUTH_COLOUR, angle_label, palette
from mission.recording.entities import child
from mission.recording.rerun_places import log_pose
from mission.recording.room_frames import RoomFrames
from mission.recording.shots import Line, Shot, shot
from mission.rigid import Pose

if TYPE_CHECKING:
    from detector.room import Wall
    from sim.photo import Photo


LABEL = 0.08
"""Height of a label in heights of the picture."""


class Photos:
    """Shows the first photograph of each scan, and when a room is done those that show most of its doors."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._frames = RoomFrames()
        self._base_from_scanner: Pose = np.eye(4)
        self._room_from_scanner: Pose = np.eye(4)
        self._fresh: list[Photo] = []
        self._shots: list[Shot] = []
        self._walls: tuple[Wall, ...] = ()
        self._order: list[str] = []

    @singledispatchmethod
    def draw(self, event: Event) -> None:
        """Draw one event; most are no matter of photographs."""

    @draw.register
    def _(self, event: MissionStarted) -> None:
        self._base_from_scanner = event.base_from_scanner

    @draw.register
    def _(self, event: RoomEntered) -> None:
        self._frames.follow(event)
        self._room_from_scanner = event.world_from_base @ self._base_from_scanner

    @draw.register
    def _(self, event: RoomsTied) -> None:
        self._frames.follow(event)
        for taken in self._shots:
            taken.world_from_room = self._frames[taken.room]

    @draw.register
    def _(self, event: Photographed) -> None:
        self._fresh = list(event.photos)
        for photo in self._fresh[:1]:
            self._show(entities.CAMERA, shot(photo, event.room, self._room_from_scanner, self._frames[event.room]))

    @draw.register
    def _(self, event: Drove) -> None:
        for last in event.world_from_base[-1:]:
            self._room_from_scanner = last @ self._base_from_scanner

    @draw.register
    def _(self, event: Registered) -> None:
        frame = self._frames[event.room]
        shots = [shot(photo, event.room, event.world_from_scanner, frame) for photo in self._fresh]
        for first in shots[:1]:
            self._show(entities.CAMERA, first)
        if event.accepted:  # of another scan nobody knows where it was
            self._shots += shots
        self._fresh = []

    @draw.register
    def _(self, event: DoorsDetected) -> None:
        self._walls = tuple(result.wall for result in event.results)

    @draw.register
    def _(self, event: DoorsEvaluated) -> None:
        """The photograph that shows most of the room's doors, and for each wall that of its doors."""
        self._order += [door.door_id for door in event.doors if door.door_id not in self._order]
        shots = [taken for taken in self._shots if taken.room == event.room]
        self._shots = [taken for taken in self._shots if taken.room != event.room]
        if not event.doors or not shots:
            return
        self._show_best(entities.CAMERA, event.doors, event.doors, shots)
        for wall in sorted({evaluation.wall for evaluation in event.doors}):
            entity = child(entities.SHOTS, entities.wall_name(event.room, wall))
            self._show_best(entity, [door for door in event.doors if door.wall == wall], event.doors, shots)

    def _show_best(
        self, entity: str, doors: Sequence[DoorEvaluation], all_doors: Sequence[DoorEvaluation], shots: Sequence[Shot]
    ) -> None:
        """Show the photograph that shows most of some doors, with all doors of the room."""

        def shown(taken: Shot) -> float:
            seen = [door for door in doors if taken.sees(door.corners_in_world, self._walls)]
            return taken.shows([quad for door in seen for quad in (door.corners_in_world, *door.leaf_corners_in_world)])

        best = max(shots, key=shown)
        self._show(entity, best, [door for door in all_doors if best.sees(door.corners_in_world, self._walls)])

    def _show(self, entity: str, taken: Shot, doors: Sequence[DoorEvaluation] = ()) -> None:
        log_pose(self._rec, entity, taken.world_from_camera)
        self._rec.log(
            entity,
            rr.Pinhole(
                image_from_camera=taken.intrinsics, width=taken.width, height=taken.height, image_plane_distance=0.4
            ),
        )
        self._rec.log(f"{entity}/photo", rr.EncodedImage(contents=taken.jpeg, media_type="image/jpeg"))
        self._draw_doors(f"{entity}/doors", taken, doors)

    def _draw_doors(self, entity: str, taken: Shot, doors: Sequence[DoorEvaluation]) -> None:
        """Doorways and leaves as they were measured, the joints' leaves thin and white; nothing where no door is."""
        measured: list[tuple[list[Line], tuple[int, int, int], str]] = []
        for door in doors:
            lines = [
                line for quad in (door.corners_in_world, *door.leaf_corners_in_world) for line in taken.outline(quad)
            ]
            if lines:
                measured.append(
                    (lines, palette(self._order.index(door.door_id)), f"{door.door_id}: {angle_label(door)}")
                )
        true = [line for door in doors for leaf in door.true_leaf_corners_in_world for line in taken.outline(leaf)]
        self._rec.log(
            f"{entity}/measured",
            rr.LineStrips2D(
                [line for lines, _, _ in measured for line in lines],
                colors=[colour for lines, colour, _ in measured for _ in lines],
                radii=rr.Radius.ui_points(2.5),
            ),
        )
        self._rec.log(f"{entity}/joint", rr.LineStrips2D(true, colors=TRUTH_COLOUR, radii=rr.Radius.ui_points(0.8)))
        self._rec.log(
            f"{entity}/labels",
            rr.Points2D(
                label_places([_top(lines) for lines, _, _ in measured], pitch=LABEL * taken.height),
                labels=[label for _, _, label in measured],
                colors=[colour for _, colour, _ in measured],
                radii=0.0,
                show_labels=True,
            ),
        )


def _top(lines: Sequence[Line]) -> tuple[float, float]:
    """The middle above lines in a picture."""
    ends = np.concatenate(lines)
    return float((ends[:, 0].min() + ends[:, 0].max()) / 2), float(ends[:, 1].min())


def label_places(tops: Sequence[tuple[float, float]], *, pitch: float) -> list[tuple[float, float]]:
    """Where to write above doors in a picture: no two in one line, for the words are as wide as the picture."""
    places = dict.fromkeys(range(len(tops)), (0.0, 0.0))
    lowest = -np.inf
    for number in sorted(places, key=lambda number: tops[number][1]):
        lowest = max(tops[number][1] - pitch, lowest + pitch)
        places[number] = tops[number][0], lowest
    return list(places.values())
