"""From room to room: through a door for the first time, and back through doors that are known."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from mission.events import Event
from mission.exits import Exit
from mission.explored_building import CompletedRoom, Doorway, ExploredBuilding
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.mopad import Mopad
from mission.navigation import NavigationParameters, plan_path
from mission.rigid import inverted, transformed
from mission.surveyor import Surveyor

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
        approach = self._approach(here, way) if here == way.face.room else None
        if approach is None:
            yield surveyor.remark(f"door {way.face.door_id} is out of reach")
            return here, False
        room = self._building.rooms[here]
        path, spot = approach
        floor, threshold = room.structure.floor_height, way.at(parameters.exits.threshold)
        failed = f"an obstacle in door {way.face.door_id}"
        if (yield from surveyor.drive(room.explored, np.vstack([path, threshold]), floor)):
            failed = f"no place to turn is in sight behind door {way.face.door_id}"
            tied = yield from surveyor.scan_threshold(room.explored, beyond)
            landing = self._landing(beyond, way, floor) if tied else None
            if landing is not None and (yield from surveyor.drive(beyond, self._straight_to(landing), floor)):
                doorway = Doorway({here: spot, beyond.number: landing})
                self._building.pass_through(doorway, here, beyond.number, self._mopad.world_from_base[:3, 3])
                surveyor.room = beyond.number
                return beyond.number, True
        yield surveyor.remark(failed)
        yield from surveyor.drive(room.explored, self._straight_to(spot), floor)
        return here, False

    def come_back(self, beyond: ExploredRoom, way: Exit) -> Generator[Event, None, int]:
        """Return from a place behind an exit that is no room.

        Returns:
            The room that the robot is in.
        """
        room = self._building.rooms[way.face.room]
        doorway = next(doorway for doorway in self._building.doorways if beyond.number in doorway.spots)
        path = np.vstack([self._straight_to(doorway.spots[beyond.number]), doorway.spots[way.face.room]])
        self._surveyor.room = way.face.room
        yield from self._surveyor.drive(room.explored, path, room.structure.floor_height)
        return way.face.room

    def _drive_to_room(self, here: int, goal: int) -> Generator[Event, None, int]:
        """Drive from room to room through the doors that the robot knows.

        Returns:
            The room that it comes to.
        """
        building, mopad = self._building, self._mopad
        for doorway in building.route(here, goal):
            room = building.rooms[here]
            (there,) = (other for other in doorway.spots if other != here)
            here_from_there = inverted(building.world_from_room[here]) @ building.world_from_room[there]
            landing = transformed(np.array([[*doorway.spots[there], 0.0]]), here_from_there)[:, :2]
            path = self._path(room, doorway.spots[here])
            floor = room.structure.floor_height
            if path is None or not (yield from self._surveyor.drive(room.explored, np.vstack([path, landing]), floor)):
                return here
            mopad.believe(inverted(here_from_there) @ mopad.world_from_base)
            here = self._surveyor.room = there
        return here

    def _approach(self, here: int, way: Exit) -> tuple[NDArray[np.float64], Place] | None:
        """Way (P, 2) to the nearest place before an exit where the robot can turn towards it, and that place."""
        for distance in self._distances():
            path = self._path(self._building.rooms[here], way.at(-distance))
            if path is not None:
                return path, way.at(-distance)
        return None

    def _landing(self, beyond: ExploredRoom, way: Exit, floor_height: float) -> Place | None:
        """The nearest place straight behind an exit where the robot can turn, as seen from the doorway."""
        grid = beyond.grid(floor_height)
        needed = self._footprint.half_diagonal + self._parameters.margin
        places = (way.at(distance) for distance in self._distances())
        return next((place for place in places if grid.clearance_at(place) >= needed), None)

    def _distances(self) -> NDArray[np.float64]:
        """From a wall's plane to where the robot may turn [m]."""
        exits = self._parameters.exits
        return np.arange(exits.nearest, exits.furthest, 0.05)

    def _path(self, room: CompletedRoom, goal: Place) -> NDArray[np.float64] | None:
        pose = self._mopad.world_from_base
        return plan_path(room.grid, pose, goal, footprint=self._footprint, parameters=self._parameters)

    def _straight_to(self, goal: Place) -> NDArray[np.float64]:
        """(2, 2) from where the robot stands."""
        return np.vstack([self._mopad.world_from_base[:2, 3], goal])
