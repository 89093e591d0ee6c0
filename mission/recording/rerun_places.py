"""What is drawn in the frames of rooms in the Rerun recording, and where the rooms lie."""

from __future__ import annotations

import numpy as np
import rerun as rr

from mission.events import Event
from mission.recording.room_frames import RoomFrames
from mission.rigid import Pose


def log_pose(rec: rr.RecordingStream, entity: str, world_from_x: Pose) -> None:
    """Log where something stands."""
    rec.log(entity, rr.Transform3D(translation=world_from_x[:3, 3], mat3x3=world_from_x[:3, :3]))


class Places:
    """Keeps entities where their rooms lie by now."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Place entities of a recording."""
        self._rec = rec
        self._frames = RoomFrames()
        self._in_room: dict[str, int] = {}

    def __getitem__(self, room: int) -> Pose:
        """world_from_room (4, 4)."""
        return self._frames[room]

    def follow(self, event: Event) -> None:
        """Take note of one event, and move what was drawn in rooms that lie elsewhere now."""
        moved = self._frames.follow(event)
        for entity, room in self._in_room.items():
            if room in moved:
                log_pose(self._rec, entity, moved[room])

    def belongs(self, entity: str, room: int) -> None:
        """Draw an entity in the frame of a room from now on."""
        if entity not in self._in_room:
            self._in_room[entity] = room
            pose = self._frames[room]
            if not np.array_equal(pose, np.eye(4)):
                log_pose(self._rec, entity, pose)
