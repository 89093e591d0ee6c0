"""A door as one room sees it: what rooms are linked by, and what the robot drives through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from detector.orthoimage import column_medians
from detector.result import Door, WallResult
from detector.room import Wall

CLOSED = np.radians(8.0)
"""A leaf at a smaller angle lies near enough to the wall for its recess to be read from the orthoimage [rad]."""
_DEEPEST = 0.4
"""What lies further from the wall's plane is no closed leaf [m]."""
_INSET = 0.15
"""Share of the doorway at each side that is left out: rebates, hinges, gaps."""


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
    """Depth of a leaf behind the wall's plane in the middle of the doorway, from its columns in the orthoimage."""
    if not door.leaves or not all(leaf.opening_angle < CLOSED for leaf in door.leaves):  # NaN compares false
        return float("nan")
    r, depth, size = door.rectangle, result.merged.depth, result.merged.pixel_size
    columns = np.arange(depth.shape[1]) * size + size / 2
    heights = result.wall.height - (np.arange(depth.shape[0]) * size + size / 2)
    across = (columns > r.left + _INSET * r.width) & (columns < r.right - _INSET * r.width)
    middle = (r.left + r.right) / 2
    up = (heights > r.bottom + _INSET * r.height) & (heights < r.top - _INSET * r.height)
    leaf = depth[np.ix_(up, across)]
    leaf[np.abs(leaf) > _DEEPEST] = np.nan
    seen = np.count_nonzero(np.isfinite(leaf), axis=0) >= 10
    if np.count_nonzero(seen) < 10:
        return float("nan")
    at, behind = columns[across][seen], -column_medians(leaf[:, seen])
    return float(np.polyval(np.polyfit(at - middle, behind, 1), 0.0))
