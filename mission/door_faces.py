"""A door as one room sees it: what rooms are linked by, and what the robot drives through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from detector.angle import CLOSED_SHARE, slope_in_doorway
from detector.result import Door, WallResult
from detector.room import Wall

CLOSED = np.radians(8.0)
"""A leaf at a smaller angle lies near enough to the wall for its recess to be read from the orthoimage [rad]."""


@dataclass(frozen=True, eq=False)
class DoorFace:
    """One side of a door, in the frame of the room that sees it."""

    door_id: str
    """Room, wall and a letter: "1.2-a"."""
    room: int
    wall: Wall
    door: Door
    recess: float
    """Depth of the leaf behind the wall's plane in the middle of the doorway [m]; NaN where it stands open or was not
    seen. The other face sees the same place of the leaf, whichever its hinge."""

    @property
    def head(self) -> NDArray[np.float64]:
        """(3,) middle of the doorway's upper edge, in the wall's plane [m]."""
        r = self.door.rectangle
        return self.wall.world_from_wall(np.array([[(r.left + r.right) / 2, r.top, 0.0]]))[0]

    @property
    def normal(self) -> NDArray[np.float64]:
        """(3,) unit, into the room."""
        return self.wall.normal


def door_faces(results: Sequence[WallResult], *, room: int) -> tuple[DoorFace, ...]:
    """The doors of a room, wall by wall."""
    return tuple(
        DoorFace(door_name(room, number, place), room, result.wall, door, _recess(result, door))
        for number, result in enumerate(results, start=1)
        for place, door in enumerate(result.doors)
    )


def door_name(room: int, wall: int, place: int) -> str:
    """ "1.2-a" is the first door of the second wall of room 1."""
    return f"{room}.{wall}-{_letters(place)}"


def _letters(number: int) -> str:
    """ "a", "b", ... "z", "aa", "ab", ... of 0, 1, ..."""
    return (_letters(number // 26 - 1) if number >= 26 else "") + "abcdefghijklmnopqrstuvwxyz"[number % 26]


def _recess(result: WallResult, door: Door) -> float:
    """Depth of a leaf behind the wall's plane in the middle of the doorway [m]; NaN where none fills it."""
    if not door.leaves or not all(leaf.opening_angle < CLOSED for leaf in door.leaves):  # NaN compares false
        return float("nan")
    merged = result.merged
    _, depth, share = slope_in_doorway(merged.depth, door.rectangle, result.wall.height, merged.pixel_size)
    return -depth if share >= CLOSED_SHARE else float("nan")
