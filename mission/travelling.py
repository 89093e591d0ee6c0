"""From room to room: through a door for the first time, and back through doors that are known."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from mission.events import Event
from mission.exits import CentreLine, Exit
from mission.explored_building import Doorway, ExploredBuilding
from mission.explored_room import ExploredRoom
from mission.grid import Footprint, OccupancyGrid
from mission.mopad import Mopad
from mission.navigation import NavigationParameters, road_map
from mission.rigid import inverted, transformed
from mission.surveyor import MAX_DETOURS, Surveyor

Place = NDArray[np.float64]
"""(2,) in a room's frame [m]."""


class Traveller:
    """Takes the robot from room to room.

    A doorway is passed straight along its exit's centre line, between two places where the robot can turn. The first
    time it stops in the doorway, where the scanner sees both rooms, and scans: so the room behind is tied to the one
    before, and the floor behind the door is known before the robot goes there.
    """

    def __init__(
        self,
        mopad: Mopad,
        building: ExploredBuilding,
        surveyor: Surveyor,
        footprint: Footprint,
        parameters: NavigationParameters,
    ) -> None:
        self._mopad, self._building, self._surveyor = mopad, building, surveyor
        self._footprint, self._parameters = footprint, parameters

    def go_through(self, here: int, way: Exit, beyond: ExploredRoom) -> Generator[Event, None, tuple[int, bool]]:
        """Drive to an exit and through it into a new room.

        Args:
            here: Room that the robot is in.
            way: Exit of this or another room that is done.
            beyond: What is to be known of the room behind.

        Returns:
            The room that the robot is in, and whether that is the one behind.
        """
        surveyor, parameters = self._surveyor, self._parameters
        here = yield from self._drive_to_room(here, way.face.room)
        room = self._building.rooms[way.face.room]
        floor, door = room.structure.floor_height, way.face.door_id
        if here != way.face.room or not (yield from self._come_before(here, way.line)):
            yield surveyor.remark(f"door {door} is out of reach")
            return here, False
        spot = self._mopad.world_from_base[:2, 3]
        failed = f"an obstacle in door {door}"
        if (
            yield from surveyor.drive(room.explored, self._straight_to(way.line.at(parameters.exits.threshold)), floor)
        ):
            failed = f"no place to turn is in sight behind door {door}"
            tied = yield from surveyor.scan_threshold(room.explored, beyond)
            landing = self._landing(beyond.grid(floor), way.line) if tied else None
            if landing is not None and (known := self._room_at(here, landing)) is not None:
                landing, failed = None, f"door {door} leads into room {known}, which is done"
            if landing is not None and (yield from surveyor.drive(beyond, self._straight_to(landing), floor)):
                doorway = Doorway(door, {here: way.line, beyond.number: way.line.reversed()})
                self._building.pass_through(doorway, here, beyond.number, self._mopad.world_from_base[:3, 3])
                surveyor.room = beyond.number
                return beyond.number, True
        yield surveyor.remark(failed)
        yield from surveyor.drive(room.explored, self._straight_to(spot), floor)
        return here, False

    def come_back(self, way: Exit) -> Generator[Event, None, int | None]:
        """Return straight from a place behind an exit that is no room.

        Returns:
            The room that the robot is in; None if it could not get there.
        """
        room = self._building.rooms[way.face.room]
        spot = self._landing(room.grid, way.line.reversed())
        if spot is None:
            return None
        self._surveyor.room = way.face.room
        path = np.vstack([self._straight_to(way.line.at(self._parameters.exits.threshold)), spot])
        arrived = yield from self._surveyor.drive(room.explored, path, room.structure.floor_height)
        return way.face.room if arrived else None

    def _drive_to_room(self, here: int, goal: int) -> Generator[Event, None, int]:
        """Drive from room to room through the doors that the robot knows.

        Returns:
            The room that it comes to.
        """
        building, mopad = self._building, self._mopad
        for doorway in building.route(here, goal):
            room, there = building.rooms[here], doorway.beyond(here)
            landing = self._landing(building.rooms[there].grid, doorway.lines[there].reversed())
            if landing is None or not (yield from self._come_before(here, doorway.lines[here])):
                return here
            here_from_there = inverted(building.world_from_room[here]) @ building.world_from_room[there]
            beyond = np.asarray(transformed(np.array([[*landing, 0.0]]), here_from_there)[0, :2], float)
            floor = room.structure.floor_height
            if not (yield from self._surveyor.drive(room.explored, self._straight_to(beyond), floor)):
                return here
            mopad.believe(inverted(here_from_there) @ mopad.world_from_base)
            here = self._surveyor.room = there
        return here

    def _room_at(self, here: int, place: Place) -> int | None:
        """The room that is done and in which a place of another room's frame lies."""
        building = self._building
        over_floor = np.array([[*place, building.rooms[here].structure.floor_height + 1.0]])
        return building.room_at(transformed(over_floor, building.world_from_room[here])[0])

    def _come_before(self, here: int, line: CentreLine) -> Generator[Event, None, bool]:
        """Drive to where the robot can turn towards a doorway; a way that ends early leads to another.

        Returns:
            Whether it stands there.
        """
        room = self._building.rooms[here]
        for _ in range(MAX_DETOURS):
            path = self._approach(here, line)
            if path is None:
                return False
            if (yield from self._surveyor.drive(room.explored, path, room.structure.floor_height)):
                return True
        return False

    def _approach(self, here: int, line: CentreLine) -> NDArray[np.float64] | None:
        """Way (P, 2) to the nearest place before a doorway where the robot can turn towards it."""
        places = np.array([line.at(-distance) for distance in self._distances()])
        roads = road_map(
            self._building.rooms[here].grid,
            self._mopad.world_from_base,
            footprint=self._footprint,
            goals=places,
            parameters=self._parameters,
        )
        return next((path for k in range(len(places)) if (path := roads.path_to(1 + k)) is not None), None)

    def _landing(self, grid: OccupancyGrid, line: CentreLine) -> Place | None:
        """The nearest place straight behind a doorway where the robot can turn, with nothing before it."""
        needed = self._footprint.width / 2 + self._parameters.exits.margin - grid.resolution
        for place in (line.at(distance) for distance in self._distances()):
            clearance = float(grid.clearance_at(place))
            if clearance >= self._turning:
                return place
            if clearance < needed:
                return None
        return None

    @property
    def _turning(self) -> float:
        """Radius of the disc that the robot needs to turn [m]."""
        return self._footprint.half_diagonal + self._parameters.margin

    def _distances(self) -> NDArray[np.float64]:
        """From a wall's plane to where the robot may turn [m]."""
        exits = self._parameters.exits
        return np.arange(exits.nearest, exits.furthest, 0.05)

    def _straight_to(self, goal: Place) -> NDArray[np.float64]:
        """(2, 2) from where the robot stands."""
        return np.vstack([self._mopad.world_from_base[:2, 3], goal])
