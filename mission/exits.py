"""Exits: doors that stand open wide enough to drive through, as far as they were measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from detector.result import Door
from mission.door_faces import DoorFace
from mission.grid import Footprint
from sim.parameters import Parameters

_THICKNESS = 0.05
"""A leaf that stands open takes this much of the doorway where it hinges in it [m]."""
_SAME_DOORWAY = 0.5
"""Lines so close beside each other pass one doorway; along it they may be a wall's thickness apart, twice this [m]."""
_PARALLEL = 0.9
"""Lines at a larger angle pass two doorways in a corner [cosine]."""
_STEP = 0.01
"""Between the centre lines that are tried [m]."""


class ExitParameters(Parameters):
    """What the robot drives through, and where it turns before and behind."""

    margin: float = Field(default=0.07, ge=0.0, le=0.5, description="kept clear at each side in a doorway [m]")
    depth: float = Field(default=0.5, ge=0.1, le=2.0, description="of the gap before and behind the wall's plane [m]")
    threshold: float = Field(
        default=0.1, ge=-0.5, le=1.0, description="a scan in the doorway is taken so far behind the wall's plane [m]"
    )
    nearest: float = Field(default=0.6, ge=0.3, le=1.5, description="to the wall's plane of where the robot turns [m]")
    furthest: float = Field(default=2.5, ge=1.5, le=10.0, description="likewise [m]")


@dataclass(frozen=True, eq=False)
class CentreLine:
    """The line on which the robot passes a doorway, in a room's frame."""

    middle: NDArray[np.float64]
    """(2,) where it meets the wall's plane [m]."""
    out: NDArray[np.float64]
    """(2,) unit, out of the room."""

    def at(self, behind: float) -> NDArray[np.float64]:
        """(2,) the place so far behind the wall's plane; negative before it [m]."""
        return self.middle + behind * self.out

    def reversed(self) -> CentreLine:
        """The same line as a way into the room."""
        return CentreLine(self.middle, -self.out)

    def is_like(self, other: CentreLine) -> bool:
        """Whether two lines, measured at two times or from both sides of a wall, pass one doorway."""
        x, y = other.middle - self.middle
        aside, apart = abs(x * self.out[1] - y * self.out[0]), np.hypot(x, y)
        parallel = abs(float(self.out @ other.out)) > _PARALLEL
        return bool(parallel and aside < _SAME_DOORWAY and apart < 2 * _SAME_DOORWAY)


@dataclass(frozen=True, eq=False)
class Exit:
    """A way out of a room, straight through a doorway."""

    face: DoorFace
    line: CentreLine
    width: float
    """Of the gap, as the points have it [m]."""


def find_exits(
    faces: Sequence[DoorFace],
    points: NDArray[np.floating],
    *,
    floor_height: float,
    footprint: Footprint,
    robot_height: float,
    parameters: ExitParameters,
) -> tuple[list[Exit], list[tuple[DoorFace, str]]]:
    """Doors that the robot can drive through, and why not the others.

    A door's rectangle and leaves say where its gap is; the points of the scans, which also know of what stands in it,
    decide where in the gap the robot has most room, and whether enough.

    Args:
        faces: Doors of one room.
        points: (N, 3) of its scans, in its frame [m].
        floor_height: [m].
        footprint: Of the robot.
        robot_height: What is over this does not matter [m].
        parameters: How much room is enough.
    """
    exits, refused = [], []
    for face in faces:
        low, high = clear_span(face.door)
        needed = footprint.width + 2 * parameters.margin
        if high - low < needed:
            refused.append((face, f"open by {max(high - low, 0.0):.2f} m, {needed:.2f} m needed"))
            continue
        in_wall = face.wall.wall_from_world(np.asarray(points))
        up = in_wall[:, 1] + (face.wall.origin[2] - floor_height)
        inside = (np.abs(in_wall[:, 2]) < parameters.depth) & (up > 0.05) & (up < robot_height)
        inside &= (in_wall[:, 0] > low - 1.0) & (in_wall[:, 0] < high + 1.0)
        along, room = _widest(in_wall[inside, 0], low, high)
        width = 2 * room
        if width < needed - _STEP:
            refused.append((face, f"something leaves {width:.2f} m of it, {needed:.2f} m needed"))
            continue
        middle = face.wall.world_from_wall(np.array([[along, 0.0, 0.0]]))[0, :2]
        exits.append(Exit(face, CentreLine(middle, -face.normal[:2]), width))
    return exits, refused


def clear_span(door: Door) -> tuple[float, float]:
    """From where to where along the wall a doorway is open, as its leaves stand [m]; nothing if the first is larger."""
    r = door.rectangle
    low, high = r.left, r.right
    if door.kind == "sliding":
        slid = sum(leaf.slid for leaf in door.leaves)  # the detector knows sliding doors of one leaf
        return (low, low + slid) if slid > 0 else (high + slid, high)
    for place, leaf in enumerate(door.leaves):
        if not np.isfinite(leaf.opening_angle):
            continue  # a passage whose leaf, if any, stands nowhere near
        across = max(r.width / len(door.leaves) * float(np.cos(leaf.opening_angle)), _THICKNESS)
        if leaf.hinge == "right" or place > 0:
            high = min(high, r.right - across)
        else:
            low = max(low, r.left + across)
    return low, high


def _widest(across: NDArray[np.floating], low: float, high: float) -> tuple[float, float]:
    """The centre line of a gap with most room to its sides and to the points at (N,), and that room [m].

    The third nearest point counts: beams that graze an edge leave single points in the air.
    """
    lines = np.arange(low, high, _STEP) + _STEP / 2
    room = np.minimum(lines - low, high - lines)
    if len(across) > 2:
        room = np.minimum(room, np.partition(np.abs(lines[:, None] - across), 2, axis=1)[:, 2])
    best = np.flatnonzero(room >= room.max() - _STEP / 2)
    line = int(best[len(best) // 2])
    return float(lines[line]), float(room[line])
