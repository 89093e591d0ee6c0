"""What the robot knows of a building: completed rooms, the doors between them, and where each room lies.

Every room has a frame of its own: the world as the robot believed it when it came in. Links (a door seen from both
sides, a scan from the doorway, what two rooms' scans saw in common) tie the frames together in a pose graph; the first
room's frame is the map's.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mission.door_faces import DoorFace
from mission.exits import CentreLine, Exit
from mission.explored_room import ExploredRoom
from mission.grid import OccupancyGrid
from mission.linking import LinkParameters, common_scan_link, door_link, same_doors, scan_link
from mission.pose_graph import Anchor, Link, residual, solve
from mission.rigid import Pose, inverted, transformed
from mission.structure import Structure

_BEYOND = 0.8
"""So far behind the wall's plane lies what an exit leads to [m]."""

_FREE = (1.0, 0.5)
"""Of a room whose place follows from the links alone, 1 sigma [m, rad]."""

_SET_DOWN = (0.03, 0.02)
"""What the robot expects of an operator's word: 1 sigma of errors of up to 5 cm and 2 deg [m, rad]."""

_STRAINED = 10.0
"""Faces whose link the others contradict by so many deviations are not of one door."""


@dataclass(frozen=True, eq=False)
class CompletedRoom:
    """A room whose doors are judged; everything in its own frame."""

    explored: ExploredRoom
    structure: Structure
    faces: tuple[DoorFace, ...]
    exits: tuple[Exit, ...]

    @property
    def grid(self) -> OccupancyGrid:
        """Where the robot can stand and drive, by all that is known by now."""
        return self.explored.grid(self.structure.floor_height)


@dataclass(frozen=True, eq=False)
class Doorway:
    """A door that the robot has driven through."""

    door: str
    """Its face in the room that the robot came from."""
    lines: dict[int, CentreLine]
    """On which it passes, out of each of both rooms, by the room's number and in its frame."""

    def beyond(self, room: int) -> int:
        """The room on the other side."""
        return next(other for other in self.lines if other != room)


class ExploredBuilding:
    """Rooms and what links them."""

    def __init__(self, parameters: LinkParameters) -> None:
        self._parameters = parameters
        self._anchors: dict[int, Anchor] = {}
        self.rooms: dict[int, CompletedRoom] = {}
        """By their numbers."""
        self.links: list[Link] = []
        self.doorways: list[Doorway] = []
        self.world_from_room: dict[int, Pose] = {}
        """(4, 4) of every room that was entered."""
        self._given_up: list[Exit] = []

    def begin(self, room: int, place: NDArray[np.float64], how: Literal["start", "set down"]) -> None:
        """Begin a room at a place (3,) in its frame [m], told to the robot: exactly so at its start."""
        if how == "start":
            self.enter(room, place)
        else:
            self.enter(room, place, deviation=_SET_DOWN[0], turn_deviation=_SET_DOWN[1])

    def enter(
        self, room: int, place: NDArray[np.float64], *, deviation: float = 0.0, turn_deviation: float = 0.0
    ) -> None:
        """Begin a room at a place (3,) in its frame, known to a standard deviation [m] and [rad]."""
        self._anchors[room] = Anchor(place, deviation, turn_deviation)
        self.world_from_room[room] = np.eye(4)

    def drop(self, room: int) -> None:
        """Forget a room that turned out to be none."""
        self._anchors.pop(room, None)
        self.world_from_room.pop(room, None)
        self.links = [link for link in self.links if room not in (link.first, link.second)]
        self.doorways = [doorway for doorway in self.doorways if room not in doorway.lines]

    def pass_through(self, doorway: Doorway, first: int, second: int, place: NDArray[np.float64]) -> None:
        """Begin a room at a place (3,) in its frame [m], which the robot reached from another through a doorway."""
        self.enter_from(first, second, place)
        self.doorways.append(doorway)

    def enter_from(self, first: int, second: int, place: NDArray[np.float64]) -> None:
        """Begin a room at a place (3,) in its frame [m], which the robot reached from another.

        Its scans were registered on the way, so both rooms share a frame until links correct it.
        """
        self.enter(second, place, deviation=_FREE[0], turn_deviation=_FREE[1])
        self.links.append(scan_link(first, second, np.eye(4), place, self._parameters))
        self.world_from_room[second] = self.world_from_room[first].copy()

    def give_up(self, way: Exit) -> None:
        """Do not try an exit again."""
        self._given_up.append(way)

    def complete(self, room: CompletedRoom) -> None:
        """Add a room, link it to the others by their doors, and find out where all of them lie."""
        number = room.explored.number
        known = {door for link in self.links if link.doors for door in link.doors}
        others = [face for face in self.faces() if face.door_id not in known]
        pairs = same_doors(others, room.faces, self.world_from_room, self._parameters)
        new = [door_link(earlier, face, self._parameters) for earlier, face in pairs]
        self.rooms[number] = room
        self.links += new
        self._solve()
        if strained := [link for link in new if np.abs(self._residual(link)).max() > _STRAINED]:
            new = [link for link in new if link not in strained]
            self.links = [link for link in self.links if link not in strained]
            self._solve()
        driven = {frozenset((link.first, link.second)) for link in self.links if link.doors is None}
        for link in new:
            if frozenset((link.first, link.second)) not in driven:
                common = self._common(link.first, link.second)
                if common is not None:
                    self.links.append(common)
                    self._solve()

    def faces(self) -> list[DoorFace]:
        """All doors of all completed rooms."""
        return [face for room in self.rooms.values() for face in room.faces]

    def room_at(self, place_in_world: NDArray[np.float64]) -> int | None:
        """Number of the completed room that a place (3,) of the world lies in."""
        for number, room in self.rooms.items():
            here = transformed(place_in_world[None], inverted(self.world_from_room[number]))
            if room.structure.interior(here)[0]:
                return number
        return None

    def unexplored(self, room: int) -> Exit | None:
        """The next exit to take from a room: its own first, else of the room that is the fewest doors away."""
        for number in self._reached_by(room):
            for way in self.rooms[number].exits if number in self.rooms else ():
                if way not in self._given_up and not self._leads_to_known(number, way):
                    return way
        return None

    def route(self, start: int, goal: int) -> list[Doorway]:
        """The doorways to pass from one room to another, the fewest of them."""
        reached_by = self._reached_by(start)
        way: list[Doorway] = []
        room = goal
        while (passed := reached_by[room]) is not None:
            way.insert(0, passed)
            room = passed.beyond(room)
        return way

    def _reached_by(self, start: int) -> dict[int, Doorway | None]:
        """Rooms that the robot can drive to, the fewest doors first, and the last doorway on the way to each."""
        found: dict[int, Doorway | None] = {start: None}
        queue = deque([start])
        while queue:
            room = queue.popleft()
            for doorway in self.doorways:
                if room in doorway.lines and (beyond := doorway.beyond(room)) not in found:
                    found[beyond] = doorway
                    queue.append(beyond)
        return found

    def _leads_to_known(self, room: int, way: Exit) -> bool:
        """Whether an exit is a doorway that was passed, or what lies behind it is a room that is done."""
        passed = [doorway.lines[room] for doorway in self.doorways if room in doorway.lines]
        if any(line.is_like(way.line) for line in passed):
            return True
        floor = self.rooms[room].structure.floor_height
        beyond = np.array([*way.line.at(_BEYOND), floor + 1.0])
        return self.room_at(transformed(beyond[None], self.world_from_room[room])[0]) is not None

    def _residual(self, link: Link) -> NDArray[np.float64]:
        return residual(link, self.world_from_room[link.first], self.world_from_room[link.second])

    def _solve(self) -> None:
        self.world_from_room |= solve(self._anchors, self.links)

    def _common(self, first: int, second: int) -> Link | None:
        """What the scans of the second room say of the first, where both saw the same through an opening."""
        guess = inverted(self.world_from_room[first]) @ self.world_from_room[second]
        room = self.rooms[second].explored
        return common_scan_link(
            (first, self.rooms[first].explored.registrar), (second, room.samples), guess, self._parameters
        )
