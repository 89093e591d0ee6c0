"""Buildings on paper: rooms as polygons, doors and windows in their walls, and what stands where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mission.bench.walls.finishes import WHITE, Finish
from mission.bench.walls.plans import DoorPlan, Hung, Stood, Thing, WallPlan, WindowPlan

Floats = NDArray[np.float64]
Point = tuple[float, float]

_PARTY = 0.45
"""Faces of two rooms that are nearer than this are the two sides of one wall [m]."""
_CLEARANCE = 0.005
"""By which the half of a wall that belongs to one room ends before the other room's face [m]."""


@dataclass(frozen=True)
class Side:
    """What is in, on and before one wall of a room, in the wall's frame: see `mission.bench.walls.plans`."""

    paint: Finish | None = None
    """None for the room's."""
    windows: tuple[WindowPlan, ...] = ()
    hung: tuple[Hung, ...] = ()
    stood: tuple[Stood, ...] = ()


@dataclass(frozen=True)
class Pillar:
    """A column that stands free from floor to ceiling."""

    at: Point
    size: Point
    """Along its own axes [m]."""
    turned: float
    """Anticlockwise [deg]."""
    finish: Finish


@dataclass(frozen=True)
class Lowered:
    """A level box under the ceiling: a beam, a bulkhead, a lowered ceiling."""

    name: str
    lower: Point
    upper: Point
    """Two corners in plan [m]."""
    height: float
    """Of its underside above the floor [m]."""
    finish: Finish


@dataclass(frozen=True)
class Standing:
    """Something on the floor, away from walls."""

    at: Point
    """Of the middle of its back [m]."""
    turned: float
    """Anticlockwise [deg]; 0 faces -y."""
    thing: Thing


@dataclass(frozen=True)
class Room:
    """One room."""

    name: str
    corners: tuple[Point, ...]
    """Of the floor, clockwise seen from above: wall k, counted from 1, goes from corner k, its left end seen from
    inside, to the next [m]."""
    height: float
    paint: Finish
    floor: Finish
    skirting: Finish | None = WHITE
    sides: Mapping[int, Side] = field(default_factory=dict)
    """By the wall's number; walls that are not here are bare."""
    standing: tuple[Standing, ...] = ()
    pillars: tuple[Pillar, ...] = ()
    lowered: tuple[Lowered, ...] = ()
    lamps: tuple[Point, ...] = ()

    @property
    def polygon(self) -> Floats:
        """(P, 2) corners [m]."""
        return np.array(self.corners, float)

    @property
    def faces(self) -> int:
        """Number of wall faces, those of its pillars included."""
        return len(self.corners) + 4 * len(self.pillars)

    def side(self, number: int) -> Side:
        """What is at wall `number`."""
        return self.sides.get(number, Side())


@dataclass(frozen=True)
class Doorway:
    """A door and the wall that it is in."""

    name: str
    room: str
    wall: int
    """Number in that room, which its `plan` is seen from."""
    plan: DoorPlan


@dataclass(frozen=True)
class Start:
    """Where the robot is set down."""

    name: str
    at: Point
    heading: float
    """Anticlockwise from x [deg]."""


@dataclass(frozen=True)
class House:
    """A building."""

    name: str
    summary: str
    """What a reader of the file should know."""
    rooms: tuple[Room, ...]
    doors: tuple[Doorway, ...]
    starts: tuple[Start, ...]
    outer: float
    """Thickness of walls that are no other room's [m]."""
    outside: tuple[Standing, ...] = ()

    def room(self, name: str) -> Room:
        """The room of that name."""
        return next(room for room in self.rooms if room.name == name)

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """The walls' faces of all rooms."""
        return tuple(edge for room in self.rooms for edge in edges(room))


@dataclass(frozen=True, eq=False)
class Edge:
    """A wall's face in plan."""

    room: str
    number: int
    start: Floats
    """(2,) its left end seen from inside [m]."""
    end: Floats

    @cached_property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    @cached_property
    def along(self) -> Floats:
        """(2,) unit vector to the right."""
        return np.asarray((self.end - self.start) / self.length)

    @cached_property
    def outward(self) -> Floats:
        """(2,) unit vector into the wall."""
        return np.array([-self.along[1], self.along[0]])

    @property
    def degrees(self) -> float:
        """Of `along`, anticlockwise from x."""
        return float(np.degrees(np.arctan2(self.along[1], self.along[0])))


def edges(room: Room) -> list[Edge]:
    """The walls' faces, in order."""
    corners = room.polygon
    ends = np.roll(corners, -1, axis=0)
    return [Edge(room.name, k, a, b) for k, (a, b) in enumerate(zip(corners, ends, strict=True), start=1)]


def behind(house: House, edge: Edge) -> list[tuple[Edge, float, float]]:
    """Faces of other rooms on the far side of a wall: face, thickness of the wall [m], shift along it.

    A point x along the one face is at shift - x along the other.
    """
    found = []
    for other in house.edges:
        if other.room == edge.room or other.along @ edge.along > -1 + 1e-6:
            continue
        thickness = float((other.start - edge.start) @ edge.outward)
        shift = float((other.start - edge.start) @ edge.along)
        overlap = min(edge.length, shift) - max(0.0, shift - other.length)
        if 0.02 < thickness < _PARTY and overlap > 0.01:
            found.append((other, thickness, shift))
    return found


def skin(house: House, edge: Edge) -> float:
    """Thickness of what is built for a face: up to the other side of the wall [m]."""
    walls = [thickness - _CLEARANCE for _, thickness, _ in behind(house, edge)]
    return min([house.outer, *walls])


def wall_plan(house: House, edge: Edge) -> WallPlan:
    """The wall at a face, with the holes of its own doors and of those that other rooms have in it."""
    room = house.room(edge.room)
    side = room.side(edge.number)
    doors = [door.plan for door in house.doors if (door.room, door.wall) == (edge.room, edge.number)]
    for other, _, shift in behind(house, edge):
        for door in house.doors:
            if (door.room, door.wall) == (other.room, other.number):
                doors.append(_mirrored(door.plan, shift))
    return WallPlan(
        side.paint or room.paint,
        skin(house, edge),
        doors=tuple(doors),
        windows=side.windows,
        skirting=room.skirting,
    )


def thickness_at(house: House, door: Doorway) -> float:
    """Of the whole wall that a door is in [m]."""
    edge = edges(house.room(door.room))[door.wall - 1]
    middle = door.plan.left + door.plan.width / 2
    for other, thickness, shift in behind(house, edge):
        if 0 < shift - middle < other.length:
            return thickness
    return skin(house, edge)


def _mirrored(door: DoorPlan, shift: float) -> DoorPlan:
    """The doorway as it lies in the face on the other side."""
    return DoorPlan(shift - door.right, door.width, door.height, door.finish, door.frame, gap=door.gap)
