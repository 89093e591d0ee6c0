"""Where the rooms lie in the world, as far as a recording has been told."""

from __future__ import annotations

import numpy as np

from mission.events import Event, RoomEntered, RoomsTied
from mission.rigid import Pose


class RoomFrames:
    """Follows the events that place rooms. What is measured in a room is in the room's own frame."""

    def __init__(self) -> None:
        self._world_from_room: dict[int, Pose] = {}

    def __getitem__(self, room: int) -> Pose:
        """world_from_room (4, 4)."""
        return self._world_from_room.get(room, np.eye(4))

    def follow(self, event: Event) -> dict[int, Pose]:
        """Take note of one event.

        Returns:
            world_from_room (4, 4) of each room that lies elsewhere now.
        """
        match event:
            case RoomEntered():
                told = {event.room: event.world_from_room}
            case RoomsTied():
                told = event.world_from_room
            case _:
                return {}
        moved = {room: pose for room, pose in told.items() if not np.array_equal(pose, self[room])}
        self._world_from_room |= told
        return moved
