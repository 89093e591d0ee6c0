"""Scenes with severe specular highlights: lacquered doors and gloss paint that throw the flash back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from mission.bench.walls import finishes
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import WALL_PAINTS, Finish
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import NO_FRAME, DoorPlan, Maker, RoomPlan, Site, WallPlan
from sim.camera import FLASH

TRIES = 300
"""Layouts of a wall that are tried for a highlight across the border between door and wall."""


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """4 doors in 3 walls of a room; the flash lights up where wall and door meet."""
    plaster = finishes.plaster(rng, finishes.pick(rng, WALL_PAINTS), 0.03)
    paint = finishes.lacquer(rng, plaster, large=True)
    ordinary = partial(_ordinary, double=bool(rng.random() < 0.5))
    # a highlight is larger on a dark door
    walls = [_wall([_ordinary, _flush]), _wall([_flush]), _wall([ordinary], smoother=True)]
    return (room(rng, "specular", walls, paint, places=2),)


def _wall(kinds: Sequence[Callable[[np.random.Generator, Finish], DoorPlan]], *, smoother: bool = False) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [kind(rng, site.paint) for kind in kinds]
        tries = [lay_out(rng, doors, site.length) for _ in range(TRIES)]
        placed = min(tries, key=lambda doors: _way_to_edge(doors, site.feet))
        return judged_wall(rng, site, placed, finish=finishes.smoother(site.paint) if smoother else None, busy=0.4)

    return make


def _flush(rng: np.random.Generator, wall: Finish) -> DoorPlan:
    """A frameless, tight door in the wall's plane and of its paint, a shade darker: only that tells where it ends.

    It is low, so that a highlight hides much of a side.
    """
    shade = -float(rng.uniform(0.017, 0.022))
    door = replace(random_door(rng, wall), finish=finishes.shifted(wall, (shade, shade, shade)))
    height = float(rng.uniform(1.96, 2.02))
    return replace(door, height=height, frame=NO_FRAME, recess=0.0, gap=0.0005, opens="inward", panel="flat")


def _way_to_edge(doors: tuple[DoorPlan, ...], feet: tuple[float, ...]) -> float:
    """Sum over the doors of the way from an edge to the nearest middle of a highlight [m].

    That lies halfway between the places that the lens and the flash beside it stand square to. A door that stands out
    from the wall counts little: its sides show under any highlight.
    """
    middles = [foot + FLASH[0] / 2 for foot in feet]
    ways = [min(abs(edge - middle) for edge in (door.left, door.right) for middle in middles) for door in doors]
    return sum(way * (1.0 if door.recess == 0 else 0.1) for way, door in zip(ways, doors, strict=True))


def _ordinary(rng: np.random.Generator, wall: Finish, *, double: bool = False) -> DoorPlan:
    """Any lacquered door."""
    door = random_door(rng, wall, double=double)
    frame = replace(door.frame, finish=finishes.lacquer(rng, door.frame.finish))
    return replace(door, finish=finishes.lacquer(rng, door.finish), frame=frame, panel="flat")
