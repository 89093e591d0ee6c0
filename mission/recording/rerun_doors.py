"""Doors in the Rerun recording: leaves at their measured angle beside the joint's, in the world and in photographs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatchmethod
from typing import TYPE_CHECKING

import cv2
import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.evaluation import DoorEvaluation
from mission.events import (
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
from mission.recording.drawing import TRUTH_COLOUR, angle_label, closed, jpeg, palette, quads, shrink
from mission.recording.entities import child
from mission.recording.rerun_world import log_pose
from mission.recording.room_frames import RoomFrames
from mission.rigid import Pose, inverted

if TYPE_CHECKING:
    from sim.photo import Photo

PHOTO_WIDTH = 600
"""Photographs are recorded at most this wide [px]; the MCAP has them in full."""


@dataclass
class Shot:
    """A photograph for display, and where it was taken."""

    jpeg: bytes
    intrinsics: NDArray[np.float64]
    width: int
    height: int
    room: int
    room_from_camera: Pose
    """In the room's frame."""
    world_from_room: Pose

    @property
    def world_from_camera(self) -> Pose:
        """(4, 4) as far as is known."""
        return self.world_from_room @ self.room_from_camera

    def shown_area(self, corners: NDArray[np.float64]) -> float:
        """Area of the picture that quadrilaterals (N, 4, 3) in the world take up [px2], less what is cut off."""
        return sum(self._shown_area(quad) for quad in corners)

    def _shown_area(self, quad: NDArray[np.float64]) -> float:
        camera_from_world = inverted(self.world_from_camera)
        in_camera = quad @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        if in_camera[:, 2].min() < 0.1:
            return 0.0
        projected = in_camera @ self.intrinsics.T
        drawn = (projected[:, :2] / projected[:, 2:]).astype(np.float32)
        frame = np.array([[0, 0], [self.width, 0], [self.width, self.height], [0, self.height]], np.float32)
        shown = cv2.intersectConvexConvex(cv2.convexHull(drawn), frame)[0]
        return shown * shown / max(cv2.contourArea(drawn), 1.0)


class Doors:
    """Draws doors, true doors and photographs."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._frames = RoomFrames()
        self._base_from_scanner: Pose = np.eye(4)
        self._room_from_scanner: Pose = np.eye(4)
        self._fresh: list[Photo] = []
        self._shots: list[Shot] = []
        self._colours: dict[str, tuple[int, int, int]] = {}

    @singledispatchmethod
    def draw(self, event: Event) -> None:
        """Draw one event; most show no door."""

    @draw.register
    def _(self, event: MissionStarted) -> None:
        self._base_from_scanner = event.base_from_scanner
        for door in event.true_doors:
            self._draw_truth(door.name, [leaf.corners_in_world for leaf in door.leaves])

    @draw.register
    def _(self, event: RoomEntered) -> None:
        self._frames.follow(event)
        self._room_from_scanner = event.world_from_base @ self._base_from_scanner

    @draw.register
    def _(self, event: RoomsTied) -> None:
        self._frames.follow(event)
        for shot in self._shots:
            shot.world_from_room = self._frames[shot.room]

    @draw.register
    def _(self, event: Photographed) -> None:
        self._fresh = list(event.photos)
        for photo in self._fresh[:1]:
            self._show(entities.CAMERA, _shot(photo, event.room, self._room_from_scanner, self._frames))

    @draw.register
    def _(self, event: Drove) -> None:
        for last in event.world_from_base[-1:]:
            self._room_from_scanner = last @ self._base_from_scanner

    @draw.register
    def _(self, event: Registered) -> None:
        shots = [_shot(photo, event.room, event.world_from_scanner, self._frames) for photo in self._fresh]
        for shot in shots[:1]:
            self._show(entities.CAMERA, shot)
        self._shots += shots
        self._fresh = []

    @draw.register
    def _(self, event: DoorsEvaluated) -> None:
        for evaluation in event.doors:
            colour = self._colours.setdefault(evaluation.door_id, palette(len(self._colours)))
            self._draw_door(event.room, evaluation, colour=colour)
            if evaluation.true_name is not None:
                self._draw_truth(evaluation.true_name, evaluation.true_leaf_corners_in_world)
        self._show_doors(event)
        self._shots = [shot for shot in self._shots if shot.room != event.room]

    def _show_doors(self, event: DoorsEvaluated) -> None:
        """The photograph of the widest open door, and for each wall that of its doors."""
        if not event.doors:
            return
        widest = max(event.doors, key=lambda evaluation: np.nan_to_num(evaluation.door.opening_angle))
        shots = [shot for shot in self._shots if shot.room == event.room]
        self._show_best(entities.CAMERA, [widest], shots)
        for wall in sorted({evaluation.wall for evaluation in event.doors}):
            entity = child(entities.SHOTS, entities.wall_name(event.room, wall))
            self._show_best(entity, [evaluation for evaluation in event.doors if evaluation.wall == wall], shots)

    def _draw_door(self, room: int, evaluation: DoorEvaluation, *, colour: tuple[int, int, int]) -> None:
        door = child(entities.DOORS, entities.wall_name(room, evaluation.wall), evaluation.door_id)
        leaves = evaluation.leaf_corners_in_world
        label = f"{evaluation.door_id}: {angle_label(evaluation)}"
        self._rec.log(
            f"{door}/doorway",
            rr.LineStrips3D([closed(evaluation.corners_in_world)], colors=colour, radii=0.015),
        )
        self._rec.log(
            f"{door}/leaf",
            rr.LineStrips3D([closed(leaf) for leaf in leaves], colors=colour, radii=0.02),
        )
        top = evaluation.corners_in_world[2:].mean(axis=0)
        self._rec.log(f"{door}/label", rr.Points3D([top], colors=colour, radii=0.02, labels=label, show_labels=True))
        vertices, triangles = quads(leaves)
        self._rec.log(
            f"{door}/face",
            rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, albedo_factor=(*colour, 110)),
        )

    def _draw_truth(self, name: str, leaves: Sequence[NDArray[np.float64]]) -> None:
        strips = [closed(leaf) for leaf in leaves]
        self._rec.log(child(entities.TRUTH, name), rr.LineStrips3D(strips, colors=TRUTH_COLOUR, radii=0.008))

    def _show_best(self, entity: str, doors: Sequence[DoorEvaluation], shots: Sequence[Shot]) -> None:
        """Show the photograph that shows most of some doors."""
        corners = np.array([door.corners_in_world for door in doors])
        if shots:
            self._show(entity, max(shots, key=lambda shot: shot.shown_area(corners)))

    def _show(self, entity: str, shot: Shot) -> None:
        log_pose(self._rec, entity, shot.world_from_camera)
        self._rec.log(
            entity,
            rr.Pinhole(
                image_from_camera=shot.intrinsics, width=shot.width, height=shot.height, image_plane_distance=0.4
            ),
        )
        self._rec.log(f"{entity}/photo", rr.EncodedImage(contents=shot.jpeg, media_type="image/jpeg"))


def _shot(photo: Photo, room: int, room_from_scanner: Pose, frames: RoomFrames) -> Shot:
    image, factor = shrink(photo.image, width=PHOTO_WIDTH)
    height, width = image.shape[:2]
    intrinsics = np.diag([factor, factor, 1.0]) @ photo.intrinsics
    room_from_camera = room_from_scanner @ photo.scanner_from_camera
    return Shot(jpeg(image), intrinsics, width, height, room, room_from_camera, frames[room])
