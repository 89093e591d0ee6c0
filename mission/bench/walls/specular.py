"""Scenes with severe specular highlights: lacquered doors and gloss paint that throw the flash back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.walls import finishes
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import WALL_PAINTS
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import DoorPlan, Maker, RoomPlan, Site, WallPlan


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """4 doors in 3 walls of a room; the flash lights up where wall and door meet."""
    paint = finishes.glossy(rng, finishes.plaster(rng, finishes.pick(rng, WALL_PAINTS), 0.03))
    return (room(rng, "specular", [_wall(2), _wall(1), _wall(1, double=bool(rng.random() < 0.5))], paint),)


def _wall(count: int, *, double: bool = False) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [_lacquered(random_door(rng, site.paint, double=double), rng) for _ in range(count)]
        tries = [lay_out(rng, doors, site.length) for _ in range(60)]
        placed = min(tries, key=lambda doors: _way_to_edge(doors, site.feet))
        return judged_wall(rng, site, placed, busy=0.4)

    return make


def _way_to_edge(doors: tuple[DoorPlan, ...], feet: tuple[float, ...]) -> float:
    """Sum over the doors of the way from an edge to the nearest place that a scan place stands square to [m]."""
    return sum(min(abs(edge - foot) for edge in (door.left, door.right) for foot in feet) for door in doors)


def _lacquered(door: DoorPlan, rng: np.random.Generator) -> DoorPlan:
    frame = replace(door.frame, finish=finishes.glossy(rng, door.frame.finish))
    return replace(door, finish=finishes.glossy(rng, door.finish), frame=frame, panel="flat")
